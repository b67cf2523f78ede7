#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "app/case_model.h"
#include "tests/support/analytic_head.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

Plan borehole_at(double x_mm) {
    Plan plan;
    Borehole hole;
    hole.position_in_ct = test::on_analytic_head({x_mm, -80, 40});
    plan.boreholes.push_back(hole);
    return plan;
}

SkinSurface head() {
    return SkinSurface(test::analytic_head_mesh(6));
}

// In DICOM's LPS +x is the patient's left, whatever the viewer sees at the left of a picture.
TEST(SideOfPlan, IsThePatientsOwn) {
    EXPECT_EQ(side_of_plan(borehole_at(40), head()), "LEFT");
    EXPECT_EQ(side_of_plan(borehole_at(-40), head()), "RIGHT");
    EXPECT_EQ(side_of_plan(borehole_at(0), head()), "MIDDLE");
}

TEST(SideOfPlan, IsThatOfTheSkinWhereATargetLiesAcrossTheMiddle) {
    Plan plan = borehole_at(-40);
    Trajectory deep;
    deep.entry_in_ct = test::on_analytic_head({-50, -70, 40});
    deep.target_in_ct = {20, 0, 0};
    plan.trajectories.push_back(deep);
    EXPECT_EQ(side_of_plan(plan, head()), "RIGHT");
    deep.entry_in_ct = test::on_analytic_head({50, -70, 40});
    plan.trajectories.push_back(deep);
    EXPECT_EQ(side_of_plan(plan, head()), "BOTH SIDES");
}

/// Head and plan moved as a head lies otherwise in the scanner.
std::string side_when_moved(double x_mm, const RigidTransform& moved) {
    TriangleMesh mesh = test::analytic_head_mesh(6);
    for (auto& p : mesh.vertices_in_ct) p = moved * p;
    Plan plan = borehole_at(x_mm);
    plan.boreholes.front().position_in_ct = moved * plan.boreholes.front().position_in_ct;
    return side_of_plan(plan, SkinSurface(mesh));
}

TEST(SideOfPlan, CountsFromTheMiddleOfTheHeadNotFromTheOriginOfTheScanner) {
    const RigidTransform aside(Eigen::Translation3d(-100, 0, 0));
    EXPECT_EQ(side_when_moved(-40, aside), "RIGHT");
    EXPECT_EQ(side_when_moved(40, aside), "LEFT") << "though its x is negative";
}

// The nose of a head that is turned by 20 degrees lies 35 mm beside the middle of the head's box.
TEST(SideOfPlan, IsThatOfATurnedHead) {
    for (const double degrees : {-20.0, 20.0}) {
        const RigidTransform turned(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Vector3d::UnitZ()));
        EXPECT_EQ(side_when_moved(-25, turned), "RIGHT") << degrees;
        EXPECT_EQ(side_when_moved(25, turned), "LEFT") << degrees;
        EXPECT_EQ(side_when_moved(0, turned), "MIDDLE") << degrees;
    }
}

TEST(SideOfPlan, IsNotSaidWhereTheVolumeEndsWithinTheHead) {
    TriangleMesh half = test::analytic_head_mesh(6);
    for (auto& p : half.vertices_in_ct) p.x() = std::min(p.x(), 0.0);  // a flat lid in the middle
    EXPECT_EQ(side_of_plan(borehole_at(-20), SkinSurface(half)), "");
    EXPECT_EQ(side_of_plan(Plan{}, head()), "");
}

}  // namespace
}  // namespace planlight
