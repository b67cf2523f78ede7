// Plan and light at a moment of a recorded session, measured anew from its pictures alone.
#include "app/report/moment_comparison.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "app/live/review_desk.h"
#include "app/recording/recording_head.h"
#include "app/report/operation_comparison.h"
#include "app/report/recording_review.h"
#include "app/session.h"
#include "app/windows/camera_picture.h"
#include "app/windows/scene_view.h"
#include "planning_io/case/case_folder.h"
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
    /// The whole plan alone.
    void record_whole() {
        record(file_, the_case(), [&](Session& session) { whole_at_s_ = follow(session, 8); });
        read();
    }
    void record(const fs::path& file, const Case& the_case, const std::function<void(Session&)>& play) {
        simulation::RoomSettings papers;
        papers.preset = simulation::Preset::paper;
        papers.seed = 5;
        simulation::SimulatedRig room(test::example_case().volume, points_of(test::example_case().prepared.plan),
                                      papers);
        SessionRecorder recorder(std::make_unique<RecordingFile>(file),
                                 recording_head(the_case, folder_.path(), RecordMode::all, {}));
        entered_at_ = room.clock().now();
        recorder.room_entered({"A room", RoomKind::simulated, {}, room.calibration(), {}, entered_at_});
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
            check_ = event["check"];
            lit_at_s_ = seconds(Instant(event["at_ns"].get<std::int64_t>()) - *origin);
        }
    }
    /// The page of an operation shows how far off the light is in both cameras' pictures, or says why it does not.
    void expect_on_the_report(const StereoFrame& pictures) const {
        OperationFacts facts;
        facts.head = time_line_of(file_).head;
        facts.moment = OperationMoment{lit_at_s_, "aligned", pictures.left, pictures.right, {}};
        compare_moment(facts, file_);  // no case stands where it was recorded
        EXPECT_TRUE(facts.moment->compared[0].empty());
        EXPECT_NE(facts.moment->compared_words.find("are not compared: "), std::string::npos);
        compare_moment(facts, file_, the_case());
        EXPECT_NE(facts.moment->compared_words.find("Light was found at "), std::string::npos)
            << facts.moment->compared_words;
        for (const RgbImage& shown : facts.moment->compared) {
            EXPECT_EQ(shown.width, pictures.left.width);
            const auto count = [&](auto is) { return std::ranges::count_if(shown.pixels, is); };
            EXPECT_GT(count([](const Rgb& p) { return p[1] > p[0] + 60 && p[1] > p[2] + 40; }), 200)
                << "circles of light that lies where it belongs";
            EXPECT_EQ(count([](const Rgb& p) { return p[0] > p[1] + 100 && p[0] > p[2] + 100; }), 0)
                << "none lies beyond 2 mm";
        }
        const fs::path page = folder_.path() / "report.html";
        write_operation_report(facts, "{}", page);
        EXPECT_NE(read_whole(page).find(kWhatCirclesSay), std::string::npos);
        if (const char* folder = std::getenv("PLANLIGHT_PICTURES")) {  // to be looked at
            write_png(facts.moment->compared[0], fs::path(folder) / "compared-left.png");
            write_png(facts.moment->compared[1], fs::path(folder) / "compared-right.png");
        }
    }
    const Case& the_case() const { return test::example_case().prepared; }
    test::TemporaryFolder folder_;
    const fs::path file_ = folder_.path() / "session.plrec";
    double first_frame_s_ = -1, lit_at_s_ = -1;
    double whole_at_s_ = -1;
    Instant entered_at_{};
    Json check_;
};

TEST_F(MomentOfSession, IsMeasuredAnewAsTheSessionItselfMeasuredIt) {
    record_whole();
    ASSERT_GT(lit_at_s_, 0) << "the plan was never lit";
    const RecordingTimeLine line = time_line_of(file_);
    RecordedMoments moments(file_, line);
    MomentComparer comparer(the_case(), line, file_);
    const auto compared = [&](double at_s) {
        const std::size_t frame = frame_near(line, at_s);
        EXPECT_NEAR(line.frames_s[frame], at_s, 1e-6);
        return comparer.compare(moments, frame, moments.moment(frame));
    };
    const StereoFrame pictures = moments.moment(frame_near(line, lit_at_s_)).frame;
    const MomentComparison moment = compared(lit_at_s_);
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
    ASSERT_TRUE(moment.light_lines);
    EXPECT_EQ(moment.light_lines->size(), static_cast<std::size_t>(moment.light.seen));
    const std::string csv = comparison_csv(moment);
    EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), moment.places.size() + 1);
    const std::string page = comparison_section(moment, pictures, "left.png", "right.png", "head.png");
    for (const char* words : {"mm beside the plan", "left.png", "right.png", "head.png", "<polyline"})
        EXPECT_NE(page.find(words), std::string::npos) << words;
    if (const char* folder = std::getenv("PLANLIGHT_PICTURES")) {  // to be looked at
        write_png(rgb_of(brightened(pictures.left)), fs::path(folder) / "left.png");
        write_png(rgb_of(brightened(pictures.right)), fs::path(folder) / "right.png");
        write_png(render_scene(scene_of(moment, std::make_shared<TriangleMesh>(the_case().skin)), view_of(moment)),
                  fs::path(folder) / "head.png");
        write_safely(fs::path(folder) / "index.html", review_page(line, {}, {}, page));
    }
    expect_on_the_report(pictures);
    const MomentComparison dark = compared(first_frame_s_);
    EXPECT_EQ(dark.why_not, "No patient had been found by then.");
    Case another = the_case();
    another.volume_hash = "0123456789abcdef";
    EXPECT_THROW(MomentComparer(another, line, file_), InputError);
    EXPECT_EQ(compared(lit_at_s_).drawn, moment.drawn) << "drawn once for a match";
}

// What a reviewer sees: the place of the plan that was picked is followed from frame to frame.
TEST_F(MomentOfSession, IsShownWithThePlaceThatWasPicked) {
    record_whole();
    ASSERT_GT(lit_at_s_, 0) << "the plan was never lit";
    write_case(the_case(), folder_.path() / "case");
    ReviewDesk desk(file_, folder_.path() / "case", lit_at_s_);
    const auto settled = [&] {
        for (const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(5);;) {
            auto model = desk.model();
            if (model->settled) return model;
            if (std::chrono::steady_clock::now() > until) throw std::runtime_error("the desk never settled");
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
    };
    const auto shown = settled();
    EXPECT_EQ(shown->note, "");
    ASSERT_GT(shown->places.size(), 20u);
    ASSERT_TRUE(shown->scene);
    EXPECT_FALSE(shown->cameras[0].plan.empty());
    EXPECT_LT(shown->cameras[0].round_plan[2], shown->cameras[0].picture->width);
    // A press on the plan in a picture finds the place there, and one far from it none.
    const auto seen = std::find_if(shown->places.begin(), shown->places.end(),
                                   [](const ReviewModel::Place& place) { return place.off_mm && place.pixel[0]; });
    ASSERT_NE(seen, shown->places.end());
    const auto number = static_cast<std::size_t>(seen - shown->places.begin());
    EXPECT_EQ(place_near(*shown, 0, *seen->pixel[0] + Eigen::Vector2d(0.2, 0.1)), number);
    EXPECT_FALSE(place_near(*shown, 0, Eigen::Vector2d(-200, -200)));
    EXPECT_NE(seen->words.find("mm beside the plan"), std::string::npos) << seen->words;
    desk.take({ReviewWish::Kind::pick, 0, seen->p_in_ct});
    EXPECT_EQ(desk.model()->picked, number);
    desk.take({ReviewWish::Kind::frame_before});
    const auto before = settled();
    ASSERT_TRUE(before->picked);
    EXPECT_LT((before->places[*before->picked].p_in_ct - seen->p_in_ct).norm(), 4);
    EXPECT_LT(*before->frame_s, *shown->frame_s);
    desk.take({ReviewWish::Kind::begin});
    const auto dark = settled();
    EXPECT_EQ(dark->note, "No patient had been found by then.");
    EXPECT_FALSE(dark->picked) << "nothing is claimed of a moment without a plan";
    EXPECT_TRUE(dark->places.empty());
}

// What was hidden is not missing, and what was dark is called dark.
TEST_F(MomentOfSession, IsComparedWithWhatWasLitThen) {
    double whole_s = 0, hidden_s = 0, alone_s = 0, landmark_s = 0, dark_s = 0;
    record(file_, the_case(), [&](Session& session) {
        whole_s = follow(session, 6);
        session.hide_item(0);
        hidden_s = follow(session, 6);
        session.light_item(1);
        alone_s = follow(session, 6);
        session.light_landmark(0);
        landmark_s = follow(session, 6);
        session.go_dark();
        dark_s = follow(session, 1);
    });
    const RecordingTimeLine line = time_line_of(file_);
    RecordedMoments moments(file_, line);
    MomentComparer comparer(the_case(), line, file_);
    const auto at = [&](double at_s) {
        const std::size_t frame = frame_near(line, at_s);
        return comparer.compare(moments, frame, moments.moment(frame));
    };
    const auto items = [](const MomentComparison& moment) {
        std::set<int> lit;
        for (const auto& place : moment.places) lit.insert(place.seen.item);
        return lit;
    };
    const MomentComparison whole = at(whole_s), hidden = at(hidden_s), alone = at(alone_s);
    EXPECT_EQ(whole.unlit, "");
    ASSERT_TRUE(items(whole).contains(0));
    EXPECT_FALSE(items(hidden).contains(0));
    EXPECT_GE(items(hidden).size(), 2U);
    EXPECT_GT(hidden.light.seen, hidden.light.expected / 2);
    EXPECT_NE(hidden.unlit.find("1 of "), std::string::npos) << hidden.unlit;
    EXPECT_LT(hidden.plan[0].size(), whole.plan[0].size()) << "nor does the page draw it";
    EXPECT_EQ(items(alone), (std::set<int>{1}));
    EXPECT_GT(alone.light.seen, 0);
    const MomentComparison landmark = at(landmark_s), dark = at(dark_s);
    EXPECT_EQ(landmark.unlit, "Landmark 1 alone was lit.");
    EXPECT_EQ(dark.unlit, "It was dark.");
    for (const MomentComparison& none : {landmark, dark}) {
        EXPECT_TRUE(none.places.empty());
        EXPECT_TRUE(sum_of(none).starts_with(none.unlit)) << sum_of(none);
    }
}

// Of a plan with many stretches the session looks at some in each frame, in turns; a page has time for all of them.
TEST_F(MomentOfSession, HasEveryPlaceOfALargePlan) {
    Case large = the_case();
    large.plan = test::plan_all_over(SkinSurface(large.skin), {0, -1, 0.3});
    large.plan_hash = "0123456789abcdef";
    double at_s = 0;
    record(file_, large, [&](Session& session) { at_s = follow(session, 4); });
    const RecordingTimeLine line = time_line_of(file_);
    RecordedMoments moments(file_, line);
    const std::size_t frame = frame_near(line, at_s);
    const MomentComparison moment = MomentComparer(large, line, file_).compare(moments, frame, moments.moment(frame));
    EXPECT_EQ(moment.unlit, "");
    EXPECT_GT(moment.places.size(), CheckLightSettings{}.most_segments);
    EXPECT_GT(moment.light.seen, moment.light.expected / 2);
}

}  // namespace
}  // namespace planlight
