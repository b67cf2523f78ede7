// Plan and light at a moment of a recorded session, measured anew from its pictures alone.
#include "app/report/moment_comparison.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "app/recording/recording_head.h"
#include "app/report/recording_review.h"
#include "app/session.h"
#include "app/windows/camera_picture.h"
#include "planning_io/files/image_file.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/recording/recording_reader.h"
#include "planning_io/types/error.h"
#include "registration/simulation/simulated_rig.h"
#include "tests/app/plan_all_over.h"
#include "tests/app/played_session.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// A session of the simulated room with every frame, and what its own check said of the plan's light.
class MomentOfSession : public ::testing::Test {
protected:
    void SetUp() override {
        if (!test::example_case().there) GTEST_SKIP() << "the package invesalius-examples is not installed";
    }
    /// The whole plan; without its first item; the second alone; a landmark; nothing.
    void record_all() {
        record(the_case(), [&](Session& session) {
            whole_at_s_ = follow(session, 8);
            session.hide_item(0);
            hidden_at_s_ = follow(session, 6);
            session.light_item(1);
            alone_at_s_ = follow(session, 6);
            session.light_landmark(0);
            landmark_at_s_ = follow(session, 6);
            session.go_dark();
            dark_at_s_ = follow(session, 1);
        });
        read();
    }
    void record(const Case& the_case, const std::function<void(Session&)>& play) {
        simulation::RoomSettings papers;
        papers.preset = simulation::Preset::paper;
        papers.seed = 5;
        simulation::SimulatedRig room(test::example_case().volume, points_of(test::example_case().prepared.plan),
                                      papers);
        SessionRecorder recorder(std::make_unique<RecordingFile>(file_),
                                 recording_head(the_case, folder_.path(), RecordMode::all, {}));
        entered_at_ = room.clock().now();
        recorder.room_entered({"A room", true, {}, room.calibration(), {}, entered_at_});
        const CaseDrawing drawing(the_case);
        SessionSettings settings;
        settings.observer = &recorder;
        Session session(the_case, drawing, room.calibration(), room.projector(), room.cameras(), room.clock(),
                        settings);
        session.scan();
        ASSERT_EQ(session.find_patient().verdict, Verdict::yes);
        play(session);
        ASSERT_EQ(recorder.finish(), "");
    }
    /// When the last frame was taken, seconds since the room was entered.
    double follow(Session& session, int updates) const {
        Instant at{};
        for (int i = 0; i < updates; ++i) at = session.update().frame.at;
        return seconds(at - entered_at_);
    }
    /// The last update whose check looked at the whole plan, and the first frame of all.
    void read() {
        RecordingReader reader(file_);
        std::optional<Instant> origin;
        while (const auto chunk = reader.next()) {
            if (chunk->type == chunk_types::kRoom) origin = chunk->at;
            if (chunk->type == chunk_types::kFrame && first_frame_s_ < 0) first_frame_s_ = seconds(chunk->at - *origin);
            if (chunk->type != chunk_types::kEvent) continue;
            const Json event = Json::parse(chunk->payload);
            if (!event.contains("check") || event["check"]["seen"].get<int>() < 20) continue;
            const double at_s = seconds(Instant(event["at_ns"].get<std::int64_t>()) - *origin);
            if (at_s > whole_at_s_) continue;
            check_ = event["check"];
            lit_at_s_ = at_s;
        }
    }
    const Case& the_case() const { return test::example_case().prepared; }
    test::TemporaryFolder folder_;
    const fs::path file_ = folder_.path() / "session.plrec";
    double first_frame_s_ = -1, lit_at_s_ = -1;
    double whole_at_s_ = -1, hidden_at_s_ = -1, alone_at_s_ = -1, landmark_at_s_ = -1, dark_at_s_ = -1;
    Instant entered_at_{};
    Json check_;
};

TEST_F(MomentOfSession, IsMeasuredAnewAsTheSessionItselfMeasuredIt) {
    record_all();
    ASSERT_GT(lit_at_s_, 0) << "the plan was never lit";
    const MomentComparison moment = compare_moment(file_, lit_at_s_, the_case());
    ASSERT_EQ(moment.why_not, "");
    // The session asks who sees which place anew in eight parts, and this one frame at once: not the same places.
    EXPECT_NEAR(moment.light.median_mm, check_["median_mm"].get<double>(), 0.06);
    EXPECT_NEAR(moment.light.off_mm, check_["off_mm"].get<double>(), 0.2);
    EXPECT_GT(moment.light.seen, 20);
    ASSERT_EQ(moment.places.size(), moment.light.segments.size());
    for (const auto& place : moment.places) {
        EXPECT_FALSE(place.item.empty());
        EXPECT_TRUE(place.pixel[0] || place.pixel[1]);
    }
    EXPECT_GT(moment.scene.width, 0);
    const std::string csv = comparison_csv(moment);
    EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), moment.places.size() + 1);
    const std::string page = comparison_section(moment, "left.png", "right.png", "head.png");
    for (const char* words : {"mm beside the plan", "left.png", "right.png", "head.png", "<polyline"})
        EXPECT_NE(page.find(words), std::string::npos) << words;
    if (const char* folder = std::getenv("PLANLIGHT_PICTURES")) {  // to be looked at
        write_png(rgb_of(brightened(moment.pictures[0])), fs::path(folder) / "left.png");
        write_png(rgb_of(brightened(moment.pictures[1])), fs::path(folder) / "right.png");
        write_png(moment.scene, fs::path(folder) / "head.png");
        write_safely(fs::path(folder) / "index.html", review_page(time_line_of(file_), {}, page));
    }
    const MomentComparison dark = compare_moment(file_, first_frame_s_, the_case());
    EXPECT_EQ(dark.why_not, "No patient had been found by then.");
    Case another = the_case();
    another.volume_hash = "0123456789abcdef";
    EXPECT_THROW(compare_moment(file_, lit_at_s_, another), InputError);
}

// What was hidden is not missing, and what was dark is called dark.
TEST_F(MomentOfSession, IsComparedWithWhatWasLitThen) {
    record_all();
    const auto at = [&](double at_s) { return compare_moment(file_, at_s, the_case()); };
    const auto items = [](const MomentComparison& moment) {
        std::set<int> lit;
        for (const auto& place : moment.places) lit.insert(place.seen.item);
        return lit;
    };
    const MomentComparison whole = at(whole_at_s_), hidden = at(hidden_at_s_), alone = at(alone_at_s_);
    EXPECT_EQ(whole.unlit, "");
    ASSERT_TRUE(items(whole).contains(0));
    std::set<int> rest = items(whole);
    rest.erase(0);
    EXPECT_EQ(items(hidden), rest);
    EXPECT_GT(hidden.light.seen, hidden.light.expected / 2);
    EXPECT_NE(hidden.unlit.find("1 of "), std::string::npos) << hidden.unlit;
    EXPECT_LT(hidden.plan[0].size(), whole.plan[0].size()) << "nor does the page draw it";
    EXPECT_EQ(items(alone), (std::set<int>{1}));
    EXPECT_GT(alone.light.seen, 0);
    const MomentComparison landmark = at(landmark_at_s_), dark = at(dark_at_s_);
    EXPECT_EQ(landmark.unlit, "Landmark 1 alone was lit.");
    EXPECT_EQ(dark.unlit, "It was dark.");
    for (const MomentComparison& none : {landmark, dark}) {
        EXPECT_TRUE(none.places.empty());
        EXPECT_NE(comparison_section(none, "l", "r", "h").find(none.unlit), std::string::npos);
    }
}

// Of a plan with many stretches the session looks at some in each frame, in turns; a page has time for all of them.
TEST_F(MomentOfSession, HasEveryPlaceOfALargePlan) {
    Case large = the_case();
    large.plan = test::plan_all_over(SkinSurface(large.skin), {0, -1, 0.3});
    large.plan_hash = "0123456789abcdef";
    double at_s = 0;
    record(large, [&](Session& session) { at_s = follow(session, 4); });
    const MomentComparison moment = compare_moment(file_, at_s, large);
    EXPECT_EQ(moment.unlit, "");
    EXPECT_GT(moment.places.size(), 2 * CheckLightSettings{}.most_segments);
    EXPECT_GT(moment.light.seen, moment.light.expected / 2);
}

}  // namespace
}  // namespace planlight
