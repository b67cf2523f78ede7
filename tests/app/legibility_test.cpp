// Labels of the light on the simulated head, read by tesseract: two poses here, twenty by measure_legibility.
#include <gtest/gtest.h>

#include "tests/app/labelled_head.h"
#include "tests/app/read_labels.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

TEST(Legibility, WhatWasReadIsComparedByItsLettersAndNumbers) {
    EXPECT_EQ(compare("B3/7 mm wide", "B3/7 mm wide"), Reading::right);
    EXPECT_EQ(compare("Resec…ntal/157 mm", "resec...ntal/157mm"), Reading::right);
    EXPECT_EQ(compare("Osteotomy/151 mm", "Osteotom/151 mm"), Reading::other);
    EXPECT_EQ(compare("EVD 7", "EVD?"), Reading::other);
    EXPECT_EQ(compare("B3/7 mm wide/6 mm deep", "B3/7 mm wide/76 mm deep"), Reading::other_number);
    EXPECT_EQ(compare("B3/7.5 mm wide", "B3/75 mm wide"), Reading::other_number);
    EXPECT_EQ(compare("T24", "124"), Reading::other_number);
}

TEST(Legibility, LabelsOnTheHeadAreReadAsTheyAreWritten) {
    if (!example_patient() || !can_read_labels())
        GTEST_SKIP() << "the packages invesalius-examples and tesseract-ocr are not both installed";
    const LabelledHead head;
    LabelsRead all;
    all.append(head.read(simulation::Preset::paper, 3, true));
    all.append(head.read(simulation::Preset::modern, 4, false));
    EXPECT_GE(all.lit, 12);
    EXPECT_GE(all.right, all.lit - all.unseen - 1) << (all.wrong.empty() ? "" : all.wrong.front());
    EXPECT_TRUE(all.other_number.empty()) << all.other_number.front();
    EXPECT_EQ(all.cards_lit, 2) << "the card with the patient's name and the side";
    EXPECT_GE(all.cards_seen, 1);
    EXPECT_EQ(all.cards_right, all.cards_seen) << all.cards_wrong.front();
}

}  // namespace
}  // namespace planlight::test
