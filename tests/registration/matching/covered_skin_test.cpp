#include "registration/matching/covered_skin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "registration/matching/measure_displacement.h"
#include "tests/registration/matching/matching_scenes.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

/// The scan of a face with something on it, and what of it was taken for skin: what lies within 2 mm of it.
struct Covered {
    PointCloud all;
    SkinDisplacement skin;
};

template <class Mm>
Covered covered_with(const PointCloud& still, const Mm& mm) {
    Covered made{displaced(still, [&](auto& p, auto&) { return mm(p); }), {}};
    PointCloud skin;
    for (std::size_t i = 0; i < still.size(); ++i) {
        if (mm(still.points_in_rig[i]) > 2) continue;
        skin.points_in_rig.push_back(made.all.points_in_rig[i]);
        skin.normals_in_rig.push_back(made.all.normals_in_rig[i]);
    }
    made.skin = measure_displacement(skin, head_lut(), RigidTransform::Identity());
    return made;
}

// Left out as cloth, a swelling was drawn on as if nobody had seen it: light up to 5 mm beside the plan, with a `yes`.
TEST(CoveredSkin, ASwellingIsSaidAndIsSkinThatStandsHigher) {
    const PointCloud still = head_view(View::front, 190, 40000, 3);
    Vector3d where = still.points_in_rig.front(), middle = Vector3d::Zero();
    for (const Vector3d& p : still.points_in_rig) middle += p / static_cast<double>(still.size());
    for (const Vector3d& p : still.points_in_rig)
        if ((p - middle).norm() < (where - middle).norm()) where = p;
    for (const double peak_mm : {4.0, 8.0}) {
        Covered made = covered_with(
            still, [&](const Vector3d& p) { return peak_mm * std::exp(-(p - where).squaredNorm() / (2 * 20 * 20)); });
        ASSERT_TRUE(made.skin.known());
        EXPECT_LT(SkinDisplacementField(made.skin).at(where).mm, 2);
        const double offset_mm = made.skin.offset_mm, spread_mm = made.skin.spread_mm;
        add_covered_skin(made.all, head_lut(), RigidTransform::Identity(), made.skin);
        EXPECT_NEAR(covered_by_mm(made.skin, where).value_or(0), peak_mm, 0.5);
        EXPECT_NEAR(SkinDisplacementField(made.skin).at(where).mm, peak_mm, 0.3);
        EXPECT_EQ(made.skin.offset_mm, offset_mm);
        EXPECT_EQ(made.skin.spread_mm, spread_mm);
        for (const Vector3d& p : still.points_in_rig)
            if ((p - where).norm() > 60) {
                ASSERT_FALSE(covered_by_mm(made.skin, p)) << p.transpose();
            }
    }
}

// A step, or a sheet that leaves the skin slowly and goes on: said, and no skin.
TEST(CoveredSkin, ClothIsSaidAndIsNoSkin) {
    const PointCloud still = head_view(View::front, 190, 40000, 6);
    for (const double slope : {100.0, 0.3}) {
        Covered made = covered_with(
            still, [&](const Vector3d& p) { return p.z() > 20 ? std::min(15.0, slope * (p.z() - 20)) : 0.0; });
        ASSERT_TRUE(made.skin.known());
        const std::size_t places = made.skin.places.size();
        add_covered_skin(made.all, head_lut(), RigidTransform::Identity(), made.skin);
        EXPECT_EQ(made.skin.places.size(), places) << slope;
        int under = 0, said = 0;
        for (const Vector3d& p : still.points_in_rig) {
            if (p.z() > 35) ++under, said += covered_by_mm(made.skin, p).has_value();
            if (p.z() < 12) {
                ASSERT_FALSE(covered_by_mm(made.skin, p)) << p.transpose();
            }
        }
        EXPECT_GT(said, 0.9 * under) << slope;
    }
}

TEST(CoveredSkin, OfABareFaceNothingIs) {
    const PointCloud still = spoiled(head_view(View::front, 190, 20000, 6), 0.3, 0.05, 7);
    SkinDisplacement skin = measure_displacement(still, head_lut(), RigidTransform::Identity());
    const std::size_t places = skin.places.size();
    add_covered_skin(still, head_lut(), RigidTransform::Identity(), skin);
    EXPECT_TRUE(skin.covered.empty());
    EXPECT_EQ(skin.places.size(), places);
    SkinDisplacement unknown;
    add_covered_skin(still, head_lut(), RigidTransform::Identity(), unknown);
    EXPECT_FALSE(unknown.known());
}

}  // namespace
}  // namespace planlight::test
