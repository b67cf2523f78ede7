#include "app/doctor/doctor_screen.h"

#include <gtest/gtest.h>

// What the page says of an examination.
namespace planlight {
namespace {

using PageVerdict = DoctorPageModel::Verdict;

ExaminationState over_with(std::vector<DoctorLine> lines) {
    ExaminationState state;
    state.lines = std::move(lines);
    state.over = true;
    return state;
}
const DoctorLine kGood{"left camera, rate", Health::good, "25.0 frames a second", {}},
    kLook{"rig, age", Health::look, "calibrated 100 days ago", "Calibrate it anew."},
    kStop{"computer, OpenGL", Health::stop, "no window can be drawn", "Install an OpenGL 3.3 driver."};

PageVerdict verdict(const ExaminationState& state) {
    return doctor_page_model_of(state, "Room").verdict;
}

TEST(DoctorScreen, TheVerdictIsThatOfTheWorstLine) {
    EXPECT_EQ(verdict(over_with({kGood})), PageVerdict::good);
    EXPECT_EQ(verdict(over_with({kLook, kGood})), PageVerdict::look);
    EXPECT_EQ(verdict(over_with({kGood, kStop, kLook})), PageVerdict::stop);
}

TEST(DoctorScreen, NothingIsGoodBeforeItIsOver) {
    ExaminationState state = over_with({kGood});
    state.over = false;
    EXPECT_EQ(verdict(state), PageVerdict::looking);
    state.lines.push_back(kStop);
    EXPECT_EQ(verdict(state), PageVerdict::looking);
}

TEST(DoctorScreen, WhatWasEndedByHandIsNeverGood) {
    ExaminationState state = over_with({kGood});
    state.ended_by_hand = true;
    EXPECT_EQ(verdict(state), PageVerdict::ended);
    state.lines.push_back(kLook);
    EXPECT_EQ(verdict(state), PageVerdict::ended);
    state.lines.push_back(kStop);
    EXPECT_EQ(verdict(state), PageVerdict::stop) << "what stops, stops";
}

TEST(DoctorScreen, EveryLineStandsThereWithItsRemedy) {
    const DoctorPageModel model = doctor_page_model_of(over_with({kGood, kLook, kStop}), "Room 3");
    ASSERT_EQ(model.lines.size(), 3U);
    EXPECT_EQ(model.lines[1].health, DoctorPageModel::Health::look);
    EXPECT_EQ(model.lines[1].remedy, kLook.remedy);
    EXPECT_EQ(model.lines[2].said, kStop.said);
    EXPECT_EQ(model.count(DoctorPageModel::Health::stop), 1U);
    EXPECT_EQ(model.subtitle, "Room 3");
}

}  // namespace
}  // namespace planlight
