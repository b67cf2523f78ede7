// Which match of a recording is offered, and the live session that goes on with it.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/live/live_session.h"
#include "app/live/simulated_room.h"
#include "app/recording/recording_head.h"
#include "app/recording/replay_session.h"
#include "app/recording/resume_offer.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/recording/recording_reader.h"
#include "planning_io/types/error.h"
#include "tests/app/played_session.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

/// Recordings of sessions that were cut short.
class ResumeRecording : public ::testing::Test {
protected:
    void SetUp() override {
        if (!test::example_case().there) GTEST_SKIP() << "the package invesalius-examples is not installed";
    }
    static const fs::path& recording() {
        static const test::TemporaryFolder folder;
        static const fs::path file = [] {
            test::PlayedSession how;
            how.seed = 21;
            how.updates = 12;
            const fs::path made = folder.path() / "played.plrec";
            test::record_session(how, test::example_case(), RecordMode::events, made);
            return made;
        }();
        return file;
    }
    static std::vector<RecordingChunk> chunks() {
        RecordingReader reader(recording());
        std::vector<RecordingChunk> all;
        while (auto chunk = reader.next()) all.push_back(std::move(*chunk));
        return all;
    }
    static fs::path written(const std::vector<RecordingChunk>& chunks, std::size_t count, const fs::path& file) {
        std::ofstream out(file, std::ios::binary);
        out << recording_header();
        for (std::size_t i = 0; i < count; ++i) out << chunk_bytes(chunks[i], i);
        return file;
    }
    /// The rig as it was calibrated in that session's room.
    static RigCalibration kept_rig() {
        const auto all = chunks();
        const auto room =
            std::find_if(all.begin(), all.end(), [](const auto& c) { return c.type == chunk_types::kRoom; });
        return rig_of_text(nlohmann::json::parse(room->payload)["rig"].dump(), "a recording");
    }
    /// A live session that goes on with the recording by itself, until it is ready to follow or refuses.
    static OperatorModel go_on(const fs::path& file, unsigned seed, SessionObserver* observer = nullptr) {
        simulation::RoomSettings room;
        room.preset = simulation::Preset::paper;
        room.seed = seed;
        const Case& the_case = test::example_case().prepared;
        const CaseDrawing drawing(the_case);
        ResumeOffer offer = resume_offer(file, the_case);
        offer.at_once = true;
        LiveSession session(
            [&](const RoomProgress&) {
                return std::make_unique<SimulatedRoom>(test::example_case().volume, the_case.plan, room, 20,
                                                       std::string());
            },
            the_case, drawing, {}, observer, offer);
        test::wait_for(session, "the match or a refusal",
                       [](const OperatorModel& m) { return m.track.enabled || m.status.kind == StatusKind::refused; });
        EXPECT_FALSE(session.projecting());
        if (!session.model().track.enabled) return session.model();
        session.post(OperatorAction::track);
        OperatorModel lit;
        test::wait_for(session, "light", [&](const OperatorModel& m) {
            lit = m;
            return m.status.kind == StatusKind::check && m.confirm;
        });
        EXPECT_TRUE(session.projecting());
        return lit;
    }
};

TEST_F(ResumeRecording, CutAnywhereItIsOfferedFromTheMatchOn) {
    const auto all = chunks();
    const test::TemporaryFolder folder;
    const auto match =
        std::find_if(all.begin(), all.end(), [](const auto& c) { return c.type == chunk_types::kMatch; });
    ASSERT_NE(match, all.end());
    const auto with_match = static_cast<std::size_t>(match - all.begin()) + 1;
    for (std::size_t count = 1; count <= all.size(); ++count) {
        const LastMatch last = last_match_of(written(all, count, folder.path() / "cut.plrec"));
        EXPECT_EQ(last.match.has_value(), count >= with_match) << count << " chunks: " << last.why_none;
    }
}

TEST_F(ResumeRecording, AScanThatBeganAfterItOrLightThatWasStoppedEndsTheOffer) {
    const auto all = chunks();
    const test::TemporaryFolder folder;
    const auto refused = [&](const std::string& event) {
        auto more = all;
        more.pop_back();  // DONE
        more.push_back({chunk_types::kEvent, {}, event});
        const fs::path file = written(more, more.size(), folder.path() / "more.plrec");
        EXPECT_FALSE(last_match_of(file).match);
        EXPECT_THROW(resume_offer(file, test::example_case().prepared), InputError);
    };
    refused(R"({"what":"asked","call":"scan","utc":"2026-01-01T00:00:00Z"})");
    // Looked for anew, by landmarks, and not found: the match that they contradict is not offered again.
    refused(R"({"what":"asked","call":"find_patient","utc":"2026-01-01T00:00:00Z","landmarks":[]})");
    refused(R"({"what":"gate","call":"step","at_ns":1,"trust":"dark","headline":"x","stop":true})");
}

// A power cut, and then a start that a missing camera ended: the session before is the one to go on with.
TEST_F(ResumeRecording, SessionsThatDidNothingArePassedOver) {
    const auto all = chunks();
    const test::TemporaryFolder folder;
    EXPECT_FALSE(last_session(folder.path()));
    const auto older = [&](const fs::path& file, int minutes) {
        fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::minutes(minutes));
        return file;
    };
    const fs::path before = older(written(all, all.size(), folder.path() / "before.plrec"), 30);
    older(written(all, 1, folder.path() / "ended-at-once.plrec"), 20);
    std::ofstream(folder.path() / "empty.plrec");
    older(folder.path() / "empty.plrec", 10);
    const auto found = last_session(folder.path());
    ASSERT_TRUE(found);
    EXPECT_EQ(found->recording, before);
    EXPECT_TRUE(found->last.match);

    const auto scanned = std::find_if(all.begin(), all.end(),
                                      [](const auto& c) { return c.payload.find("scanned") != std::string::npos; });
    const fs::path scan_only =
        older(written(all, static_cast<std::size_t>(scanned - all.begin()) + 1, folder.path() / "scan.plrec"), 5);
    EXPECT_EQ(last_session(folder.path())->recording, scan_only) << "there the patient was scanned anew";
    older(before, 13 * 60), older(scan_only, 13 * 60);
    EXPECT_FALSE(last_session(folder.path())) << "of yesterday";
}

TEST_F(ResumeRecording, OfAnotherCasePlanProgramOrRigIsRefusedByName) {
    const Case& the_case = test::example_case().prepared;
    const RigCalibration rig = kept_rig();
    EXPECT_NO_THROW(resume_offer(recording(), the_case));
    EXPECT_NO_THROW(resume_offer(recording(), the_case, &rig));
    Case other;
    other.code = the_case.code, other.lut.volume_hash = the_case.lut.volume_hash;
    other.lut.mesh_hash = "another";
    other.volume_hash = the_case.volume_hash, other.plan_hash = the_case.plan_hash;
    EXPECT_THROW(resume_offer(recording(), other), InputError);
    RigCalibration other_rig = rig;
    other_rig.projector.focal_x += 1;
    EXPECT_THROW(resume_offer(recording(), the_case, &other_rig), InputError);
    auto all = chunks();
    RecordingHead head = head_of(all.front().payload, "a recording");
    head.program_hash = "0123456789abcdef0123456789abcdef";
    all.front().payload = text_of(head);
    const test::TemporaryFolder folder;
    try {
        resume_offer(written(all, all.size(), folder.path() / "other.plrec"), the_case);
        ADD_FAILURE() << "the recording of another program was taken";
    } catch (const InputError& refusal) {
        EXPECT_NE(std::string(refusal.what()).find("another program"), std::string::npos) << refusal.what();
    }
}

TEST_F(ResumeRecording, TheLiveSessionGoesOnInTheSameRoomAndIsReplayed) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "second.plrec";
    {
        SessionRecorder recorder(std::make_unique<RecordingFile>(file),
                                 recording_head(test::example_case().prepared, {}, RecordMode::all, {}));
        const OperatorModel model = go_on(recording(), 21, &recorder);
        EXPECT_NE(model.status.headline.find("LOOK"), std::string::npos) << model.status.headline;
    }
    const ReplayResult replayed = replay_session(file, test::example_case().prepared);
    EXPECT_FALSE(replayed.difference) << replayed.difference->what;
    EXPECT_EQ(replayed.resumptions, 1);
    EXPECT_GE(replayed.updates, 1);
    EXPECT_TRUE(last_match_of(file).match) << "and it can be gone on with from there";
}

TEST_F(ResumeRecording, TheLiveSessionStaysDarkInAnotherRoom) {
    const OperatorModel model = go_on(recording(), 22);
    EXPECT_EQ(model.status.kind, StatusKind::refused);
    EXPECT_NE(model.status.headline.find("another rig"), std::string::npos) << model.status.headline;
    EXPECT_FALSE(model.track.enabled);
    EXPECT_TRUE(model.scan.enabled);
}

}  // namespace
}  // namespace planlight
