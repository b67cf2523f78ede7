#include "projection/clearance.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "tests/projection/shapes.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kExact_mm = 1e-6;
/// A ball of 10 mm is made of triangles with edges of up to 0.4 mm: their middles lie 2.7 um within it at most.
constexpr double kBall_mm = 10, kWithin_mm = 3e-3;

TriangleMesh moved(TriangleMesh mesh, const Vector3d& by) {
    for (auto& p : mesh.vertices_in_ct) p += by;
    return mesh;
}

RiskStructure ball_at(const Vector3d& centre, const std::string& name = "Tumour") {
    static const TriangleMesh kBall = test::ball_mesh(kBall_mm, 5);
    return {name, moved(kBall, centre)};
}

RiskStructure box(const Vector3d& low, const Vector3d& high, const std::string& name = "Dura") {
    RiskStructure made{name, {}};
    for (int corner = 0; corner < 8; ++corner)
        made.surface.vertices_in_ct.emplace_back(corner & 1 ? high.x() : low.x(), corner & 2 ? high.y() : low.y(),
                                                 corner & 4 ? high.z() : low.z());
    made.surface.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                              {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return made;
}

/// A closed cylinder along z of many flat sides, its corners on the circle.
RiskStructure rod(double radius_mm, double length_mm, const std::string& name = "Artery") {
    constexpr int kSides = 720;
    RiskStructure made{name, {}};
    auto& points = made.surface.vertices_in_ct;
    for (const double z : {-length_mm / 2, length_mm / 2}) {
        for (int i = 0; i < kSides; ++i) {
            const double turn = 2 * M_PI * i / kSides;
            points.emplace_back(radius_mm * std::cos(turn), radius_mm * std::sin(turn), z);
        }
        points.emplace_back(0, 0, z);
    }
    for (int i = 0; i < kSides; ++i) {
        const int next = (i + 1) % kSides, above = kSides + 1;
        made.surface.triangles.push_back({kSides, next, i});
        made.surface.triangles.push_back({above + kSides, above + i, above + next});
        made.surface.triangles.push_back({i, next, above + i});
        made.surface.triangles.push_back({next, above + next, above + i});
    }
    return made;
}

Clearance of(Plan plan, RiskStructure structure, const SkinSurface* skin = nullptr) {
    plan.risk_structures = {std::move(structure)};
    const auto clearances = clearances_of(plan, skin);
    EXPECT_EQ(clearances.size(), 1U);
    EXPECT_EQ(clearances.at(0).size(), 1U);
    return clearances.at(0).at(0);
}

Plan way(const Vector3d& entry, const Vector3d& target, double diameter_mm) {
    Plan plan;
    plan.trajectories.push_back({"T", entry, target, diameter_mm, {}});
    return plan;
}
Plan hole(const Vector3d& at, const Vector3d& axis, double diameter_mm, double depth_mm) {
    Plan plan;
    plan.boreholes.push_back({"B", at, axis, diameter_mm, depth_mm, {}});
    return plan;
}
Plan line(std::vector<Vector3d> points, bool closed) {
    Plan plan;
    plan.osteotomy_lines.push_back({"O", std::move(points), closed, {}});
    return plan;
}
Plan plane(const Vector3d& at, const Vector3d& normal, const Vector3d& first, double width_mm, double height_mm) {
    Plan plan;
    plan.cut_planes.push_back({"C", at, normal, first, width_mm, height_mm, {}});
    return plan;
}

TEST(Clearance, AWayPastABallIsTheBallsDistanceLessHalfTheInstrument) {
    for (const double diameter_mm : {0.0, 2.0, 4.5})
        for (const double aside_mm : {14.0, 30.0}) {
            const Clearance c = of(way({-50, aside_mm, 0}, {50, aside_mm, 0}, diameter_mm), ball_at({0, 0, 0}));
            EXPECT_FALSE(c.through);
            EXPECT_GE(c.mm, aside_mm - kBall_mm - diameter_mm / 2 - kExact_mm) << "corners lie on the ball";
            EXPECT_LE(c.mm, aside_mm - kBall_mm - diameter_mm / 2 + kWithin_mm);
        }
}

TEST(Clearance, AWayThatEndsBeforeABallEndsInAHalfBall) {
    const Clearance c = of(way({-50, 0, 0}, {-15, 0, 0}, 3), ball_at({0, 0, 0}));
    EXPECT_NEAR(c.mm, 15 - kBall_mm - 1.5, kWithin_mm);
}

TEST(Clearance, AWayIsThroughWhereItTouchesTheSurfaceAndNotAHundredthBefore) {
    const RiskStructure dura = box({-20, -20, -5}, {20, 20, 0});
    EXPECT_TRUE(of(way({-10, 0, 1}, {10, 0, 1}, 2), dura).through) << "tangent";
    const Clearance before = of(way({-10, 0, 1.01}, {10, 0, 1.01}, 2), dura);
    EXPECT_FALSE(before.through);
    EXPECT_NEAR(before.mm, 0.01, kExact_mm);
    EXPECT_TRUE(of(way({-10, 0, 0.99}, {10, 0, 0.99}, 2), dura).through);
    EXPECT_TRUE(of(way({0, 0, 30}, {1, 2, -30}, 0), dura).through) << "crosses from side to side";
}

TEST(Clearance, EdgesAndCornersOfABoxAreMetExactly) {
    const RiskStructure bone = box({-10, -10, -10}, {10, 10, 10});
    // Past the edge x = 10, y = 10 at a right angle to it, in the plane x + y = 26.
    EXPECT_NEAR(of(way({26, 0, 3}, {0, 26, 3}, 0), bone).mm, 6 / std::sqrt(2), kExact_mm);
    // Along that edge, and beyond its end.
    EXPECT_NEAR(of(way({13, 14, -30}, {13, 14, 30}, 1), bone).mm, 5 - 0.5, kExact_mm);
    EXPECT_NEAR(of(way({12, 13, 16}, {12, 13, 60}, 1), bone).mm, 7 - 0.5, kExact_mm) << "2, 3, 6 beside the corner";
}

TEST(Clearance, AnArteryAcrossTheWayIsAsFarAsItsRoundSide) {
    const Clearance c = of(way({-40, 9, 2}, {40, 9, 2}, 4), rod(3, 80));
    EXPECT_GE(c.mm, 4 - kExact_mm);
    EXPECT_NEAR(c.mm, 4, 3 * (1 - std::cos(M_PI / 720)) + kExact_mm);
    EXPECT_TRUE(of(way({-40, 4.9, 2}, {40, 4.9, 2}, 4), rod(3, 80)).through);
}

TEST(Clearance, WhatLiesWhollyWithinTheOtherGoesThrough) {
    EXPECT_TRUE(of(way({-3, 0, 0}, {3, 1, 0}, 2), ball_at({0, 0, 0})).through) << "the structure is round the way";
    EXPECT_TRUE(of(hole({0, 0, 30}, {0, 0, -1}, 40, 60), ball_at({0, 0, 0})).through) << "the hole is round it";
    EXPECT_TRUE(of(line({{1, 0, 0}, {2, 0, 0}, {2, 2, 0}}, false), ball_at({0, 0, 0})).through);
    EXPECT_TRUE(of(plane({0, 0, 1}, {0, 0, 1}, {1, 0, 0}, 4, 4), ball_at({0, 0, 0})).through);
    EXPECT_EQ(of(way({-3, 0, 0}, {3, 1, 0}, 2), ball_at({0, 0, 0})).mm, 0);
}

RiskStructure joined(const RiskStructure& a, const RiskStructure& b) {
    RiskStructure both = a;
    const auto first = static_cast<std::int32_t>(a.surface.vertices_in_ct.size());
    for (const auto& p : b.surface.vertices_in_ct) both.surface.vertices_in_ct.push_back(p);
    for (const auto& t : b.surface.triangles)
        both.surface.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    return both;
}

/// Two balls that overlap, as of a merged model, the same one twice, and one within another.
TEST(Clearance, WhatLiesWithinAnyPieceGoesThroughWhateverOtherPieceLiesThere) {
    const RiskStructure here = ball_at({0, 0, 0});
    for (const auto& both : {joined(here, ball_at({12, 0, 0})), joined(here, ball_at({1e-5, 0, 0})),
                             joined(here, box({-20, -20, -20}, {20, 20, 20}))}) {
        EXPECT_TRUE(of(way({6, 0, 1}, {6, 0, -1}, 0), both).through);
        EXPECT_FALSE(of(way({0, 30, 1}, {0, 30, -1}, 0), both).through);
    }
}

TEST(Clearance, AHoleHasAFlatBottom) {
    const RiskStructure dura = box({-50, -50, -20}, {50, 50, -8});
    const Clearance c = of(hole({0, 0, 0}, {0, 0, -1}, 14, 6), dura);
    EXPECT_FALSE(c.through) << "half a ball of 7 mm at its end would be";
    EXPECT_NEAR(c.mm, 2, kExact_mm);
    // Tilted by 30 degrees the rim of the bottom comes first: 6 cos 30 + 7 sin 30 deep.
    const Vector3d axis(std::sin(M_PI / 6), 0, -std::cos(M_PI / 6));
    EXPECT_NEAR(of(hole({0, 0, 4}, axis, 14, 6), dura).mm, 12 - 6 * std::cos(M_PI / 6) - 3.5, kExact_mm);
    // A corner beside the rim: 3 aside and 4 below.
    EXPECT_NEAR(of(hole({0, 0, 0}, {0, 0, -1}, 14, 6), box({10, -50, -20}, {50, 50, -10})).mm, 5, kExact_mm);
}

TEST(Clearance, AHoleWithoutAnAxisGoesIntoTheSkin) {
    const Vector3d at = test::on_ball(0.3, 0.2);
    Plan plan;
    plan.boreholes.push_back({"B", at, std::nullopt, 6, 10, {}});
    plan.risk_structures = {ball_at(at * (1 - 24 / at.norm()))};  // 24 mm under the skin
    const auto with_skin = clearances_of(plan, &test::ball());
    ASSERT_EQ(with_skin.at(0).size(), 1U);
    // The ball of the skin is made of flat triangles: their perpendicular is off by a degree at most.
    EXPECT_NEAR(with_skin[0][0].mm, 24 - 10 - kBall_mm, 0.1);
    EXPECT_TRUE(clearances_of(plan, nullptr).at(0).empty()) << "nobody knows where it goes";
}

TEST(Clearance, ALineCountsBetweenItsPointsAndWhereItCloses) {
    const RiskStructure nerve = ball_at({0, 0, 0}, "Nerve");
    const std::vector<Vector3d> points{{-30, 12, 0}, {-30, 40, 0}, {30, 40, 0}, {30, 12, 0}};
    EXPECT_NEAR(of(line(points, true), nerve).mm, 2, kWithin_mm) << "the way from the last point to the first";
    EXPECT_NEAR(of(line(points, false), nerve).mm, std::hypot(30, 12) - kBall_mm, kWithin_mm);
    EXPECT_NEAR(of(line({{-30, 13, 0}, {30, 13, 0}}, false), nerve).mm, 3, kWithin_mm) << "in the middle of a segment";
}

TEST(Clearance, ACutPlaneCountsWithinItsRectangle) {
    const RiskStructure bone = box({-10, -10, -10}, {10, 10, 10});
    EXPECT_NEAR(of(plane({0, 0, 17}, {0, 0, 1}, {1, 0, 0}, 8, 8), bone).mm, 7, kExact_mm);
    EXPECT_NEAR(of(plane({0, 23, 14}, {0, 0, 1}, {1, 0, 0}, 100, 20), bone).mm, 5, kExact_mm) << "3 and 4 off its edge";
    EXPECT_NEAR(of(plane({30, 0, 0}, {0, 0, 1}, {1, 0, 0}, 30, 5), bone).mm, 5, kExact_mm) << "it ends before the box";
    EXPECT_TRUE(of(plane({30, 0, 0}, {0, 0, 1}, {1, 0, 0}, 42, 5), bone).through);
}

TEST(Clearance, NoTrianglePassedByIsNearer) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> within(-40, 40);
    const auto point = [&] { return Vector3d(within(random), within(random), within(random)); };
    for (int round = 0; round < 40; ++round) {
        const RiskStructure structure = ball_at(point() / 2);
        const Vector3d a = point(), b = point();
        const Clearance c = of(way(a, b, 1), structure);
        double by_points_mm = 1e9;  // of the corners, all asked
        for (const auto& p : structure.surface.vertices_in_ct) {
            const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
            by_points_mm = std::min(by_points_mm, (p - a - t * (b - a)).norm() - 0.5);
        }
        if (c.through) {
            EXPECT_LT(by_points_mm, 0.3);
            continue;
        }
        EXPECT_LE(c.mm, by_points_mm + kExact_mm);
        EXPECT_GE(c.mm, by_points_mm - 0.01) << "corners are 0.34 mm apart";
    }
}

TEST(Clearance, WhatIsGoneThroughComesFirstAndThenTheNearest) {
    Plan plan = way({-50, 0, 0}, {50, 0, 0}, 2);
    plan.boreholes.push_back({"B", {0, NAN, 0}, Vector3d(0, 0, 1), 3, 3, {}});
    plan.risk_structures = {ball_at({0, 30, 0}, "Far"), ball_at({0, 12, 0}, "Near"), ball_at({0, 5, 0}, "Through")};
    const auto clearances = clearances_of(plan, nullptr);
    ASSERT_EQ(clearances.size(), 2U);
    EXPECT_TRUE(clearances[0].empty()) << "a hole that is not finite";
    ASSERT_EQ(clearances[1].size(), 3U);
    EXPECT_EQ(clearances[1][0].structure, "Through");
    EXPECT_EQ(clearances[1][1].structure, "Near");
    EXPECT_EQ(clearances[1][2].structure, "Far");
    EXPECT_EQ(warnings_in(clearances[1]), 2U);
    EXPECT_TRUE(clearances_of(way({0, 0, 0}, {1, 0, 0}, 0), nullptr).at(0).empty()) << "no structures";
}

TEST(Clearance, IsSaidRoundedDown) {
    EXPECT_EQ(clearance_in_words({"Facial nerve", 4.19, false}), "4.1 mm to Facial nerve");
    EXPECT_EQ(clearance_in_words({"Facial nerve", 1.9999, false}), "1.9 mm to Facial nerve");
    EXPECT_EQ(clearance_in_words({"Facial nerve", 1.99999999, false}), "2.0 mm to Facial nerve") << "of rounding";
    EXPECT_EQ(clearance_in_words({"Facial nerve", 0.04, false}), "0.0 mm to Facial nerve");
    EXPECT_EQ(clearance_in_words({"Facial nerve", 0, true}), "through Facial nerve");
    EXPECT_TRUE(warns({"", 1.9999, false}));
    EXPECT_TRUE(warns({"", 0, true}));
    EXPECT_FALSE(warns({"", 2, false}));
    EXPECT_EQ(risk_warnings("Screw 1", {{"Dura", 0, true}, {"Facial nerve", 1.27, false}, {"Orbit", 2.5, false}}),
              (std::vector<std::string>{"Screw 1: it goes through Dura",
                                        "Screw 1: it passes 1.2 mm from Facial nerve (less than 2 mm)"}));
}

}  // namespace
}  // namespace planlight
