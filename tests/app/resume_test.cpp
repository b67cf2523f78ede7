// A session goes on with the match of one that was cut short when all is as it was; else it stays dark and says why.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "app/live/live_session.h"
#include "app/live/simulated_room.h"
#include "app/recording/recording_head.h"
#include "app/recording/replay_session.h"
#include "app/recording/resume_offer.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"
#include "registration/simulation/simulated_rig.h"
#include "tests/app/played_session.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using simulation::SimulatedRig;

/// One room, scanned and matched by a session that is over; what it kept went through a file.
class Resume : public ::testing::Test {
protected:
    struct World {
        CaseDrawing drawing{test::example_case().prepared};
        std::unique_ptr<SimulatedRig> rig;
        std::string kept;
    };
    static World made(unsigned seed) {
        World w;
        const Case& the_case = test::example_case().prepared;
        simulation::RoomSettings room;
        room.preset = simulation::Preset::paper;
        room.seed = seed;
        w.rig = std::make_unique<SimulatedRig>(test::example_case().volume, points_of(the_case.plan), room);
        w.rig->set_motion({0.0, w.rig->clock().now()});
        Session session(the_case, w.drawing, w.rig->calibration(), w.rig->projector(), w.rig->cameras(),
                        w.rig->clock());
        session.scan();
        session.find_patient();
        session.confirm();
        w.kept = text_of(*session.kept_match());
        return w;
    }
    static const World& world() {
        static const World one = made(11);
        return one;
    }
    void SetUp() override {
        if (!test::example_case().there) GTEST_SKIP() << "the package invesalius-examples is not installed";
    }
    static SimulatedRig& rig() { return *world().rig; }
    static KeptMatch kept() { return kept_match_of(world().kept, "a recording"); }
    static Session session(const Case& the_case = test::example_case().prepared) {
        return {the_case, world().drawing, rig().calibration(), rig().projector(), rig().cameras(), rig().clock()};
    }
    /// The plan's points by what the session believes against where they truly are, mm.
    static double off_mm(const Session& session, const Session::Update& update) {
        const RigidTransform found = *update.pose.rig_from_patient * session.registration()->patient_from_ct;
        const RigidTransform truth = rig().true_rig_from_ct(update.frame.at);
        double worst = 0;
        for (const Vector3d& p : points_of(session.plan())) worst = std::max(worst, (found * p - truth * p).norm());
        return worst;
    }
    static void expect_gone_on_with() {
        Session again = session();
        again.resume(kept());
        ASSERT_NE(again.registration(), nullptr);
        const auto update = again.update();
        EXPECT_TRUE(update.overlay.lit) << update.overlay.reason;
        // The match of the example patient is within a millimetre (app/ACCURACY.md), its pose within some tenths.
        EXPECT_LT(off_mm(again, update), 1.2);
    }
    /// Refused with these words, no match, and after the stripes nothing but darkness.
    static void expect_dark(Session& again, const KeptMatch& match, const std::string& words) {
        try {
            again.resume(match);
            ADD_FAILURE() << "it was gone on with; expected: " << words;
        } catch (const CheckFailedError& refusal) {
            EXPECT_NE(std::string(refusal.what()).find(words), std::string::npos) << refusal.what();
        }
        EXPECT_EQ(again.registration(), nullptr);
        EXPECT_THROW(again.update(), CheckFailedError);
    }
    static void expect_refused(const std::string& words) {
        Session again = session();
        expect_dark(again, kept(), words);
    }
};

TEST_F(Resume, NothingMoved) {
    expect_gone_on_with();
}

TEST_F(Resume, TheHeadMovedWithItsMarkers) {
    rig().set_motion({20, rig().clock().now()});
    rig().wait(std::chrono::seconds(3));
    rig().set_motion({0, rig().clock().now()});
    expect_gone_on_with();
}

TEST_F(Resume, WhatWasKeptReadsBackBitForBit) {
    EXPECT_EQ(text_of(kept()), world().kept);
}

TEST_F(Resume, AHeadThatMovedAgainstItsMarkersIsRefused) {
    // A head that slid, or turned, under a stiff cap: only the skin can tell. In every direction, for a head is no
    // sphere.
    for (const Vector3d& way : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1)}) {
        for (const double mm : {3.0, 15.0}) {
            KeptMatch match = kept();
            for (PatientMarker& marker : match.markers) marker.centre_in_patient += mm * way;
            Session again = session();
            expect_dark(again, match, "where ");
        }
    }
}

/// A slipped sticker does not slip back to its place: a room of its own for each.
TEST_F(Resume, StickersThatWereMovedAreRefused) {
    for (const auto& [marker, slide] : {std::pair(0, Vector3d(1.5, 0, 1.5)), std::pair(-1, Vector3d(2.5, 0, 2.5))}) {
        const World own = made(12);
        own.rig->slip_marker(marker, slide);
        Session again(test::example_case().prepared, own.drawing, own.rig->calibration(), own.rig->projector(),
                      own.rig->cameras(), own.rig->clock());
        expect_dark(again, kept_match_of(own.kept, "a recording"), "marker");
    }
}

TEST_F(Resume, ARigThatWasBumpedIsRefused) {
    const double half_a_degree = 0.5 * std::numbers::pi / 180;
    for (const auto device :
         {SimulatedRig::Device::left_camera, SimulatedRig::Device::right_camera, SimulatedRig::Device::projector}) {
        rig().bump(device, half_a_degree * Vector3d(0, 1, 0));
        expect_refused("the last match is not used");
        rig().bump(device, -half_a_degree * Vector3d(0, 1, 0));
    }
    expect_gone_on_with();
}

TEST_F(Resume, MarkersThatAreCoveredAreRefusedAndTriedAgain) {
    rig().cover_markers({0, 1, 2, 3, 4, 5, 6, 7});
    Session again = session();
    expect_dark(again, kept(), "markers");
    rig().cover_markers({});
    again.resume(kept());
    EXPECT_TRUE(again.update().overlay.lit);
}

TEST_F(Resume, AnotherCasePlanOrRigIsRefused) {
    KeptMatch match = kept();
    match.registration.of_case.mesh_hash = "another";
    Session again = session();
    expect_dark(again, match, "it is of the case");
    match = kept();
    match.plan_hash = "another";
    expect_dark(again, match, "plan");
    match = kept();
    match.registration.rig->calibrated.hash = "another";
    expect_dark(again, match, "another rig");
    match = kept();
    match.registration.verdict = Verdict::no;
    expect_dark(again, match, "no match");
}

TEST_F(Resume, AMatchThatNobodyLookedAtStaysUnlit) {
    KeptMatch match = kept();
    match.registration.verdict = Verdict::ask;
    match.confirmed = false;
    Session again = session();
    again.resume(match);
    EXPECT_FALSE(again.update().overlay.lit);
    again.confirm();
    EXPECT_TRUE(again.update().overlay.lit);
}

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
        const auto wait = [&](auto holds) {
            for (int i = 0; i < 30000 && !holds(session.model()); ++i) {
                session.rethrow_fault();
                std::this_thread::sleep_for(std::chrono::milliseconds(10));
            }
        };
        wait([](const OperatorModel& m) { return m.track.enabled || m.status.kind == StatusKind::refused; });
        EXPECT_FALSE(session.projecting());
        if (!session.model().track.enabled) return session.model();
        session.post(OperatorAction::track);
        OperatorModel lit;
        wait([&](const OperatorModel& m) {
            lit = m;
            return m.status.kind == StatusKind::check && m.confirm;
        });
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
    refused(R"({"what":"gate","call":"step","at_ns":1,"trust":"dark","headline":"x","stop":true})");
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

/// The projector is unplugged in the middle of a session, and comes back.
class ProjectorAway : public ::testing::Test {
protected:
    void SetUp() override {
        if (!test::example_case().there) GTEST_SKIP() << "the package invesalius-examples is not installed";
    }
    template <class Holds>
    static void wait(LiveSession& session, Holds holds) {
        for (int i = 0; i < 30000 && !holds(session.model()); ++i) {
            session.rethrow_fault();
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
    }
    /// Follows until the light is green (and, with a fault, until it is not any more), then the projector is away;
    /// gives what is said once Track was pressed again.
    static OperatorModel come_back(const std::string& fault) {
        simulation::RoomSettings room;
        room.preset = simulation::Preset::paper;
        room.seed = 23;
        const Case& the_case = test::example_case().prepared;
        const CaseDrawing drawing(the_case);
        LiveSession session(
            [&](const RoomProgress&) {
                return std::make_unique<SimulatedRoom>(test::example_case().volume, the_case.plan, room, 5, fault);
            },
            the_case, drawing, {});
        wait(session, [](const OperatorModel& m) { return m.scan.enabled; });
        session.post(OperatorAction::scan);
        wait(session, [](const OperatorModel& m) { return m.do_register.enabled; });
        session.post(OperatorAction::do_register);
        wait(session, [](const OperatorModel& m) { return m.track.enabled; });
        session.post(OperatorAction::track);
        std::string said;
        bool green = false;
        wait(session, [&](const OperatorModel& m) {
            if (m.confirm && m.confirm_words != said) {
                said = m.confirm_words;
                session.post(OperatorAction::confirm);
            }
            green |= m.status.kind == StatusKind::aligned;
            return green && (fault.empty() || m.status.kind != StatusKind::aligned);
        });
        EXPECT_TRUE(green);
        session.look_before_light();
        session.post(OperatorAction::dark);
        wait(session, [&](const OperatorModel& m) { return m.track.enabled && !session.projecting(); });
        session.post(OperatorAction::track);
        wait(session,
             [&](const OperatorModel& m) { return session.projecting() || m.status.kind == StatusKind::refused; });
        const OperatorModel model = session.model();
        if (model.status.kind == StatusKind::refused) {
            EXPECT_FALSE(session.projecting());
            // And so it stays: another press looks again.
            session.post(OperatorAction::track);
            wait(session, [](const OperatorModel& m) { return m.status.kind != StatusKind::refused; });
            wait(session, [](const OperatorModel& m) { return m.status.kind == StatusKind::refused; });
            EXPECT_FALSE(session.projecting());
        }
        return model;
    }
};

TEST_F(ProjectorAway, TheLightComesBackWhenAllIsAsItWas) {
    EXPECT_NE(come_back({}).status.kind, StatusKind::refused);
}

TEST_F(ProjectorAway, AProjectorThatWasMovedMeanwhileStaysDark) {
    const OperatorModel model = come_back("projector");
    EXPECT_EQ(model.status.kind, StatusKind::refused);
    EXPECT_NE(model.status.headline.find("the rig has moved"), std::string::npos) << model.status.headline;
}

}  // namespace
}  // namespace planlight
