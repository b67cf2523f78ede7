// What `review` shows of a recording.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/live/review_desk.h"
#include "app/recording/recording_head.h"
#include "app/report/html_page.h"
#include "app/report/operation_report.h"
#include "app/report/recorded_moments.h"
#include "app/report/recording_review.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/recording/packed_pictures.h"
#include "planning_io/recording/recording_chunk.h"
#include "planning_io/types/error.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

/// A recording made by hand, so that what it must show is known: 10 s dark, 10 s amber, 10 s green, at 10 Hz, and a
/// frame a second whose left picture has the second as its grey.
class RecordingReview : public ::testing::Test {
protected:
    static constexpr Instant kBegan = std::chrono::seconds(500);
    test::TemporaryFolder folder_;
    fs::path file_ = folder_.path() / "made.plrec";
    std::ofstream out_;
    std::uint64_t number_ = 0;

    void put(const ChunkType& type, Instant at, const std::string& payload) {
        out_ << chunk_bytes({type, kBegan + at, payload}, number_++);
    }
    void event(Instant at, const nlohmann::ordered_json& json) { put(chunk_types::kEvent, at, json.dump()); }
    void make() {
        out_.open(file_, std::ios::binary);
        out_ << recording_header();
        RecordingHead head;
        head.case_code = head.case_title = "1234";
        head.settings = R"({"light_delay_ms": 25})";
        put(chunk_types::kHead, -kBegan, text_of(head));
        put(chunk_types::kRoom, {}, R"({"utc": "2026-03-14T09:30:00Z"})");
        event(milliseconds(1), {{"what", "matched"}, {"verdict", "yes"}, {"predicted_mm", {0.3, 0.4}}});
        for (int i = 0; i < 300; ++i) {
            const Instant at = milliseconds(100 * i + 50);
            const bool lit = i >= 100;
            const auto ns = (kBegan + at).count();
            if (i % 10 == 0) {
                StereoFrame frame{GrayImage(32, 24, static_cast<std::uint8_t>(i / 10)), GrayImage(32, 24, 9),
                                  kBegan + at, milliseconds(5), static_cast<std::uint64_t>(i)};
                put(chunk_types::kFrame, at, pack_frame(frame));
                if (lit) put(chunk_types::kPicture, at + milliseconds(20), pack_picture(RgbImage(16, 12, {0, 255, 0})));
            }
            event(at, {{"what", "updated"},
                       {"number", i},
                       {"at_ns", ns},
                       {"exposure_ns", 5},
                       {"pose", {{"bound_95_mm", 0.3}}},
                       {"light", {{"lit", lit}}},
                       {"delay_ns", 0},
                       {"check", {{"off_mm", 7}}}});
            event(at, {{"what", "gate"},
                       {"call", "step"},
                       {"at_ns", ns},
                       {"trust", !lit      ? "dark"
                                 : i < 200 ? "look"
                                           : "aligned"},
                       {"headline", "words"},
                       {"off_mm", lit ? nlohmann::json(i == 250 ? 0.9 : 0.2) : nlohmann::json()}});
        }
    }
    void finish(bool whole) {
        if (whole) put(chunk_types::kDone, std::chrono::seconds(30), "{}");
        out_.close();
    }
};

TEST_F(RecordingReview, ShowsTheGatesColoursAndTheErrorsOverTime) {
    make();
    finish(true);
    const RecordingTimeLine line = time_line_of(file_);
    double seconds_of[3] = {0, 0, 0}, worst_mm = 0;
    for (const auto& s : line.stretches) {
        seconds_of[static_cast<std::size_t>(s.trust)] += s.to_s - s.from_s;
        worst_mm = std::max(worst_mm, s.off_mm);
        if (s.trust != LightTrust::dark) {
            EXPECT_NEAR(s.predicted_mm, 0.5, 1e-9) << "0.4 of the match, 0.3 of the pose";
        }
    }
    for (const double s : seconds_of) EXPECT_NEAR(s, 10, 0.11) << "an update every 0.1 s";
    EXPECT_EQ(worst_mm, 0.9) << "the gate's figure, not another off_mm";
    EXPECT_EQ(line.frames_s.size(), 30u);
    EXPECT_EQ(line.ended, "");
    const auto colours = std::count_if(line.events.begin(), line.events.end(), [](const auto& event) {
        return event.what.starts_with("Dark: ") || event.what.starts_with("Amber: ") ||
               event.what.starts_with("Green: ");
    });
    EXPECT_EQ(colours, 3);
    const std::string page = review_page(line, {}, {{"x.png", "A picture <of> it"}});
    EXPECT_NE(page.find("A picture &lt;of&gt; it"), std::string::npos);
    const auto of = [&](LightTrust trust) { return duration_text(seconds_of[static_cast<std::size_t>(trust)]); };
    EXPECT_NE(page.find("aligned for " + of(LightTrust::aligned) + ", to be looked at for " + of(LightTrust::look) +
                        ", dark for " + of(LightTrust::dark) + "."),
              std::string::npos);
    EXPECT_NE(page.find(sign_of(PageVerdict::Kind::look)), std::string::npos) << "nobody has judged it yet";
    EXPECT_NE(page.find("not been read through yet"), std::string::npos);
    const std::string judged = review_page(line, PageVerdict{PageVerdict::Kind::good, "All was well.", {"So it was."}});
    EXPECT_NE(judged.find("All was well."), std::string::npos);
    EXPECT_NE(judged.find("So it was."), std::string::npos);
    EXPECT_EQ(judged.find("not been read through yet"), std::string::npos);
    EXPECT_NE(judged.find("0.90 mm beside the plan"), std::string::npos);
    EXPECT_NE(page.find("0.90 mm beside the plan (95 % of it), 25.1 s after"), std::string::npos);
    const auto figures = nlohmann::json::parse(review_json(line));
    EXPECT_EQ(figures["frames_s"].size(), 30u);
    EXPECT_EQ(figures["stretches"].size(), line.stretches.size());
}

TEST_F(RecordingReview, AnotherReasonOfTheSameColourIsAnEventAndAnotherNumberIsNone) {
    make();
    const auto rule = [&](int ms, const char* headline) {
        event(milliseconds(ms),
              {{"what", "updated"}, {"at_ns", (kBegan + milliseconds(ms)).count()}, {"light", {{"lit", true}}}});
        event(milliseconds(ms),
              {{"what", "gate"}, {"call", "step"}, {"trust", "look"}, {"headline", headline}, {"details", {"x"}}});
    };
    rule(30100, "the light is 0.7 mm off");
    rule(30200, "the light is 0.8 mm off");
    rule(30300, "a hand is in the light");
    rule(30400, "a hand is in the light");
    finish(true);
    std::vector<std::string> last;
    for (const auto& event : time_line_of(file_).events)
        if (event.at_s > 30) last.push_back(event.what);
    EXPECT_EQ(last, (std::vector<std::string>{"Amber: the light is 0.7 mm off", "Amber: a hand is in the light"}));
}

// As `follow` does it: the gate is asked before anything is drawn, and there is no update any more.
TEST_F(RecordingReview, LightThatStopsAfterACheckOfTheSkinIsOnTheTimeLine) {
    make();
    event(milliseconds(31000), {{"what", "skin_checked"}, {"known", true}, {"off_mm", 3.0}});
    event(milliseconds(31200), {{"what", "gate"},
                                {"call", "forbids"},
                                {"at_ns", (kBegan + milliseconds(29950)).count()},
                                {"trust", "dark"},
                                {"headline", "Dark: the skin lies 3.0 mm off where the markers put it."},
                                {"stop", true},
                                {"off_mm", 0.2}});
    finish(true);
    const RecordingTimeLine line = time_line_of(file_);
    EXPECT_EQ(line.stretches.back().trust, LightTrust::dark);
    EXPECT_NEAR(line.stretches.back().from_s, 31.2, 1e-6);
    EXPECT_EQ(line.stretches.back().off_mm, -1) << "nothing was measured then";
    EXPECT_EQ(line.events.back().what, "Dark: the skin lies 3.0 mm off where the markers put it.");
    EXPECT_NEAR(line.events.back().at_s, 31.2, 1e-6);
}

TEST_F(RecordingReview, AFrameByItsTimeHasThePictureThatCameAfterIt) {
    make();
    finish(true);
    const RecordingTimeLine line = time_line_of(file_);
    ASSERT_EQ(line.places.size(), line.frames_s.size());
    RecordedMoments moments(file_, line);
    for (const std::size_t second : {17, 15, 16}) {  // in any order
        const RecordedMoment moment = moments.moment(frame_near(line, static_cast<double>(second) + 0.2));
        EXPECT_NEAR(moment.at_s, static_cast<double>(second) + 0.05, 1e-9);
        EXPECT_EQ(moment.frame.left.at(3, 3), second);
        ASSERT_FALSE(moment.light.empty());
        EXPECT_EQ(moment.light.at(0, 0), (Rgb{0, 255, 0}));
        const RgbImage all = picture_of(moment);
        EXPECT_EQ(all.height, 24);
        EXPECT_EQ(all.width, 32 + 8 + 32 + 8 + 32);
    }
    EXPECT_TRUE(moments.moment(0).light.empty()) << "it was dark";
    EXPECT_FALSE(moments.rig_from_patient(12)) << "the pose of these updates has no place";
    EXPECT_FALSE(moments.match(12));
}

// `--record events` keeps the frames before an event once it has happened.
TEST_F(RecordingReview, FramesThatWereWrittenLaterStandInTheirOrderWithTheirUpdates) {
    make();
    RigidTransform pose = RigidTransform::Identity();
    pose.translation().x() = 7;
    std::vector<double> rows;
    for (Eigen::Index i = 0; i < 16; ++i) rows.push_back(pose.matrix()(i / 4, i % 4));
    const auto frame = [&](int ms) {
        put(chunk_types::kFrame, milliseconds(ms),
            pack_frame({GrayImage(32, 24, 77), GrayImage(32, 24, 9), kBegan + milliseconds(ms), milliseconds(5), 1}));
    };
    event(milliseconds(30100), {{"what", "updated"},
                                {"at_ns", (kBegan + milliseconds(30100)).count()},
                                {"pose", {{"rig_from_patient", rows}}}});
    frame(30200);
    frame(30100);
    finish(true);
    const RecordingTimeLine line = time_line_of(file_);
    ASSERT_EQ(line.frames_s.size(), 32u);
    EXPECT_TRUE(std::is_sorted(line.frames_s.begin(), line.frames_s.end()));
    RecordedMoments moments(file_, line);
    EXPECT_EQ(moments.moment(30).frame.left.at(0, 0), 77);
    ASSERT_TRUE(moments.rig_from_patient(30));
    EXPECT_EQ(moments.rig_from_patient(30)->translation().x(), 7);
    EXPECT_FALSE(moments.rig_from_patient(31));
}

TEST_F(RecordingReview, IsSteppedThroughByFramesAndByEvents) {
    make();
    finish(true);
    const RecordingTimeLine line = time_line_of(file_);
    EXPECT_EQ(frame_near(line, -5), 0u);
    EXPECT_EQ(frame_near(line, 1e6), 29u);
    EXPECT_EQ(frame_near(line, 3.54), 3u);
    EXPECT_EQ(frame_near(line, 3.56), 4u);
    // Every event is met once, forwards and backwards, and there is none beyond the ends.
    std::vector<double> on, back;
    for (auto at_s = next_event_s(line, -1); at_s; at_s = next_event_s(line, *at_s)) on.push_back(*at_s);
    for (auto at_s = event_before_s(line, 1e6); at_s; at_s = event_before_s(line, *at_s)) back.push_back(*at_s);
    std::reverse(back.begin(), back.end());
    EXPECT_EQ(on, back);
    ASSERT_EQ(on.size(), 4u) << "the match, dark, amber, green";
    EXPECT_NEAR(on[2], 10.05, 1e-6);
    EXPECT_EQ(line.events[*event_at(line, on[2])].what, "Amber: words");
    EXPECT_FALSE(event_at(line, -1));
    EXPECT_EQ(stretch_at(line, on[2])->trust, LightTrust::look);
    EXPECT_EQ(stretch_at(line, on[2] - 0.01)->trust, LightTrust::dark);
    EXPECT_EQ(stretch_at(line, 31), nullptr) << "nothing was followed";
}

/// What the desk shows once all that there is of a moment is there.
std::shared_ptr<const ReviewModel> settled(ReviewDesk& desk) {
    for (const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(2);;) {
        auto model = desk.model();
        if (model->settled) return model;
        if (std::chrono::steady_clock::now() > until) throw std::runtime_error("the desk never settled");
        std::this_thread::sleep_for(milliseconds(2));
    }
}

TEST_F(RecordingReview, ADeskGoesWhereThePersonWantsAndShowsThePicturesOfThatMoment) {
    using Kind = ReviewWish::Kind;
    make();
    finish(true);
    ReviewDesk desk(file_, folder_.path() / "no-case", 12);
    const auto first = settled(desk);
    EXPECT_NE(first->note.find("Plan and light are not compared"), std::string::npos) << first->note;
    EXPECT_EQ(desk.model(), first) << "nothing is new";
    const auto grey_after = [&](const ReviewWish& wish) {
        desk.take(wish);
        const auto shown = settled(desk);
        EXPECT_NEAR(*shown->frame_s, shown->cameras[0].picture->at(0, 0) + 0.05, 1e-6) << "frames and times agree";
        return static_cast<int>(shown->cameras[0].picture->at(0, 0));
    };
    EXPECT_EQ(grey_after({Kind::none}), 12);
    EXPECT_EQ(grey_after({Kind::frame_after}), 13);
    EXPECT_TRUE(settled(desk)->light);
    EXPECT_EQ(grey_after({Kind::frame_before}), 12);
    EXPECT_EQ(grey_after({Kind::event_before}), 10) << "amber";
    EXPECT_EQ(grey_after({Kind::event_after}), 20) << "green";
    EXPECT_EQ(grey_after({Kind::event_after}), 20) << "there is no other";
    EXPECT_EQ(grey_after({Kind::to_time, 3.4}), 3);
    EXPECT_FALSE(settled(desk)->light) << "it was dark";
    EXPECT_EQ(settled(desk)->now_s, 3.4) << "the moment itself, not that of its frame";
    EXPECT_EQ(grey_after({Kind::end}), 29);
    EXPECT_EQ(grey_after({Kind::frame_after}), 29);
    EXPECT_EQ(grey_after({Kind::begin}), 0);
    EXPECT_EQ(grey_after({Kind::frame_before}), 0);
    for (int i = 0; i < 200; ++i) desk.take({Kind::to_time, static_cast<double>(i % 29)});
    EXPECT_EQ(grey_after({Kind::to_time, 7.1}), 7) << "what was scrubbed over does not come after it";
}

TEST_F(RecordingReview, ADeskSaysWhenARecordingCannotBeRead) {
    ReviewDesk none(folder_.path() / "none.plrec");
    EXPECT_THROW(settled(none), InputError);
}

// The page passes over pictures; that they are whole is not said without a look.
TEST_F(RecordingReview, OneBitThatWasChangedInAPictureIsFound) {
    make();
    finish(true);
    RecordingTimeLine line = time_line_of(file_);
    look_at_pictures(line, file_);
    EXPECT_EQ(line.ended, "");
    EXPECT_FALSE(line.damaged_pictures);
    std::fstream bytes(file_, std::ios::in | std::ios::out | std::ios::binary);
    const auto at = static_cast<std::streamoff>(line.places.at(15).frame) + 60;
    bytes.seekg(at);
    const char was = static_cast<char>(bytes.get());
    bytes.seekp(at);
    bytes.put(static_cast<char>(was ^ 1));
    bytes.close();
    line = time_line_of(file_);
    EXPECT_EQ(line.frames_s.size(), 30U) << "what happened is shown to its end";
    look_at_pictures(line, file_);
    EXPECT_TRUE(line.damaged_pictures);
    EXPECT_NE(line.ended.find("damaged among its pictures"), std::string::npos) << line.ended;
}

// An hour of pictures takes minutes to be read: who wants to see what happened does not wait for that.
TEST_F(RecordingReview, PageAndMomentAreThereBeforeThePicturesAreLookedAtAndTellOfDamageAfterwards) {
    make();
    finish(true);
    RecordingTimeLine line = time_line_of(file_);
    const fs::path out = folder_.path() / "out";
    fs::create_directory(out);
    const auto page = [&] { return read_whole(out / "index.html"); };
    const auto figures = [&] { return nlohmann::json::parse(read_whole(out / "review.json")); };
    const auto show = [&](ReviewedMoment& moment) {
        EXPECT_NE(page().find("What happened"), std::string::npos);
        EXPECT_EQ(figures()["ended"], "");
        moment.pictures = {{"frame.png", "both cameras"}};
    };
    const auto find_damage = [&](RecordingTimeLine& looked_at) {
        EXPECT_NE(page().find("frame.png"), std::string::npos) << "its picture does not wait either";
        looked_at.damaged_pictures = true;
        looked_at.ended = "damaged among its pictures";
        return PageVerdict{PageVerdict::Kind::good, "What was read is good.", {}};
    };
    write_review(line, out, show, find_damage);
    EXPECT_NE(page().find("verdict stop"), std::string::npos) << "what is damaged is not good";
    EXPECT_NE(page().find("damaged among its pictures"), std::string::npos);
    EXPECT_NE(page().find("frame.png"), std::string::npos);
    EXPECT_EQ(figures()["ended"], "damaged among its pictures");
    for (const char* file : {"index.html", "review.json"})
        EXPECT_EQ(fs::status(out / file).permissions(), fs::perms(0600)) << file;
    bool looked_at = false;
    const auto look = [&](RecordingTimeLine&) {
        looked_at = true;
        return PageVerdict{PageVerdict::Kind::good, "All was well.", {}};
    };
    const auto unreadable = [&](ReviewedMoment&) { throw DamagedFileError(file_, "a piece of it does not read", "x"); };
    EXPECT_THROW(write_review(line, out, unreadable, look), DamagedFileError);
    EXPECT_TRUE(looked_at) << "that one moment does not read is not all that is to be said";
    looked_at = false;
    line = time_line_of(file_);
    const auto no_frames = [&](ReviewedMoment&) { throw InputError(file_, "kept no frame then", "x"); };
    EXPECT_THROW(write_review(line, out, no_frames, look), InputError);
    EXPECT_TRUE(looked_at);
    EXPECT_NE(page().find("All was well."), std::string::npos) << "judged all the same";
}

TEST_F(RecordingReview, SaysWhatTheClockOnTheWallWasAtItsBeginningAndWhatTheSessionWasTold) {
    make();
    finish(true);
    const RecordingTimeLine line = time_line_of(file_);
    const auto figures = nlohmann::json::parse(review_json(line));
    EXPECT_EQ(figures["room_entered"], "2026-03-14T09:30:00Z");
    EXPECT_EQ(figures["settings"]["light_delay_ms"], 25);
    EXPECT_NE(review_page(line, {}).find("2026-03-14 09:30:00 UTC"), std::string::npos);
}

// Its bytes are as they were written: a program wrote it that names things otherwise.
TEST_F(RecordingReview, AnEventOfTheWrongKindIsDamageAndNoFaultOfOurs) {
    make();
    event(milliseconds(31000), {{"what", "refused"}, {"call", 7}, {"why", {"a", "b"}}});
    finish(true);
    EXPECT_THROW(time_line_of(file_), DamagedFileError);
}

TEST_F(RecordingReview, ARecordingThatWasCutIsShownUpToThere) {
    make();
    finish(false);
    fs::resize_file(file_, fs::file_size(file_) - 40);
    const RecordingTimeLine line = time_line_of(file_);
    EXPECT_NE(line.ended, "");
    EXPECT_NEAR(line.lasted_s, 30, 0.2);
    std::ofstream(file_, std::ios::binary) << recording_header();
    EXPECT_THROW(time_line_of(file_), DamagedFileError);
}

}  // namespace
}  // namespace planlight
