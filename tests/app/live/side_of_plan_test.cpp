#include <gtest/gtest.h>

#include "app/case_model.h"
#include "tests/support/analytic_head.h"

namespace planlight {
namespace {

Case head_with_borehole_at(double x_mm) {
    Case made;
    made.skin = test::analytic_head_mesh(6);
    Borehole hole;
    hole.position_in_ct = test::on_analytic_head({x_mm, -80, 40});
    made.plan.boreholes.push_back(hole);
    return made;
}

// In DICOM's LPS +x is the patient's left, whatever the viewer sees at the left of a picture.
TEST(SideOfPlan, IsThePatientsOwn) {
    EXPECT_EQ(side_of_plan(head_with_borehole_at(40)), "LEFT");
    EXPECT_EQ(side_of_plan(head_with_borehole_at(-40)), "RIGHT");
    EXPECT_EQ(side_of_plan(head_with_borehole_at(0)), "MIDDLE");
}

TEST(SideOfPlan, IsThatOfTheSkinWhereATargetLiesAcrossTheMiddle) {
    Case made = head_with_borehole_at(-40);
    Trajectory deep;
    deep.entry_in_ct = test::on_analytic_head({-50, -70, 40});
    deep.target_in_ct = {20, 0, 0};
    made.plan.trajectories.push_back(deep);
    EXPECT_EQ(side_of_plan(made), "RIGHT");
    deep.entry_in_ct = test::on_analytic_head({50, -70, 40});
    made.plan.trajectories.push_back(deep);
    EXPECT_EQ(side_of_plan(made), "BOTH SIDES");
}

TEST(SideOfPlan, CountsFromTheMiddleOfTheHeadNotFromTheOriginOfTheScanner) {
    Case made = head_with_borehole_at(-40);
    for (auto& p : made.skin.vertices_in_ct) p.x() -= 100;
    made.plan.boreholes.front().position_in_ct.x() -= 100;
    EXPECT_EQ(side_of_plan(made), "RIGHT");
    made.plan.boreholes.front().position_in_ct.x() += 80;
    EXPECT_EQ(side_of_plan(made), "LEFT") << "though its x is negative";
}

TEST(SideOfPlan, IsNotSaidWhereTheVolumeEndsWithinTheHead) {
    Case half = head_with_borehole_at(-20);
    for (auto& p : half.skin.vertices_in_ct) p.x() = std::min(p.x(), 0.0);  // a flat lid in the middle
    EXPECT_EQ(side_of_plan(half), "");
    EXPECT_EQ(side_of_plan(Case{}), "");
}

}  // namespace
}  // namespace planlight
