#include "app/doctor/running_examination.h"

#include <gtest/gtest.h>

#include "planning_io/case/frames_folder.h"
#include "tests/support/test_data.h"

// An examination that a window watches, in a recorded room without a projector.
namespace planlight {
namespace {

using std::chrono::milliseconds;

class RunningExaminationTest : public ::testing::Test {
protected:
    const test::TemporaryFolder folder_;
    SteadyClock clock_;
    RoomFile room_;

    void SetUp() override {
        std::vector<StereoFrame> frames(5);
        for (std::size_t i = 0; i < frames.size(); ++i) {
            frames[i].left = frames[i].right = GrayImage(32, 24, static_cast<std::uint8_t>(10 + i));
            frames[i].at = milliseconds(40) * static_cast<int>(i);
            frames[i].exposure = milliseconds(10);
            frames[i].number = i;
        }
        write_frames(frames, folder_.path() / "frames");
        room_.rig = folder_.path() / "rig.json";  // there is none: a line of its own
        room_.recorded = RoomRecording{};
        room_.recorded->frames = folder_.path() / "frames";
    }
    static ExamineSettings quick(Instant watch = milliseconds(200)) {
        ExamineSettings settings;
        settings.watch = watch;
        return settings;
    }
    /// As the loop of a window does, until `ready` or for twenty seconds; or as one that answers nothing.
    template <typename Ready>
    bool watch(RunningExamination& examination, const Ready& ready, bool answers = true) {
        const Instant until = clock_.now() + std::chrono::seconds(20);
        while (clock_.now() < until) {
            if (answers) examination.answer();
            if (ready(examination.state())) return true;
            std::this_thread::sleep_for(milliseconds(5));
        }
        return false;
    }
    static bool over(const ExaminationState& state) { return state.over; }
};

std::vector<std::string> subjects(const std::vector<DoctorLine>& lines) {
    std::vector<std::string> all;
    for (const DoctorLine& line : lines) all.push_back(line.subject);
    return all;
}

TEST_F(RunningExaminationTest, FindsTheLinesThatAnExaminationWithoutAWindowFinds) {
    RunningExamination examination(room_, quick());
    ASSERT_TRUE(watch(examination, over));
    EXPECT_EQ(subjects(examination.state().lines), subjects(examine_room(room_, quick())));
    EXPECT_FALSE(examination.state().ended_by_hand);
}

TEST_F(RunningExaminationTest, ALineIsThereBeforeTheNextStepEnds) {
    RunningExamination examination(room_, quick(std::chrono::seconds(2)));
    EXPECT_TRUE(watch(examination, [](const ExaminationState& state) {
        return state.under_way == "the cameras" && !state.over && !state.lines.empty();
    }));
}

// The window system may be asked from the main thread alone.
TEST_F(RunningExaminationTest, WaitsForAnAnswerOfTheWindowSystem) {
    RunningExamination examination(room_, quick());
    const bool asks = watch(
        examination, [](const ExaminationState& state) { return state.under_way == "this computer"; }, false);
    EXPECT_TRUE(asks);
    std::this_thread::sleep_for(milliseconds(50));
    EXPECT_EQ(examination.state().under_way, "this computer") << "nobody answered";
    EXPECT_TRUE(examination.state().lines.empty());
    EXPECT_TRUE(watch(examination, over));
}

TEST_F(RunningExaminationTest, EndsByHandWhileItWaits) {
    RunningExamination examination(room_, quick());
    examination.end();
    ASSERT_TRUE(watch(examination, over));
    EXPECT_TRUE(examination.state().ended_by_hand);
    EXPECT_TRUE(examination.state().under_way.empty());
}

TEST_F(RunningExaminationTest, WhatIsOverCannotBeEndedByHand) {
    RunningExamination examination(room_, quick());
    ASSERT_TRUE(watch(examination, over));
    examination.end();
    EXPECT_FALSE(examination.state().ended_by_hand);
}

}  // namespace
}  // namespace planlight
