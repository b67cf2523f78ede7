#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "planning_io/types/statistics.h"
#include "segmentation/build_skin_lut.h"
#include "segmentation/segment_skin.h"
#include "segmentation/skin_thickness.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

constexpr double kSkin_mm = 70, kBlur_mm = 0.8;
const Vector3d kBoneCentre(3, -2, 1);  // soft tissue is thinner on one side
// Bone of 1000 HU under 40 HU crosses 300 HU where 27 % of the blurred edge is bone: 0.611 standard deviations outside
// it.
constexpr double kCrossing_mm = 0.611 * kBlur_mm;

double share(double distance_mm) {
    return 0.5 * std::erfc(distance_mm / kBlur_mm / std::numbers::sqrt2);
}

/// A CT of a ball of soft tissue with a ball of bone in it, on turned voxel axes.
Volume ball_with_bone(double bone_radius_mm) {
    Volume volume;
    volume.modality = "CT";
    volume.is_hu = true;
    volume.size = {120, 120, 105};
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.3, Vector3d(1, 2, -1).normalized()).toRotationMatrix();
    volume.ct_from_voxel.linear() = turn * Vector3d(1.3, 1.3, 1.5).asDiagonal();
    volume.ct_from_voxel.translation() = -(volume.ct_from_voxel.linear() * Vector3d(59.6, 59.3, 52.1));
    for (int k = 0; k < volume.size[2]; ++k)
        for (int j = 0; j < volume.size[1]; ++j)
            for (int i = 0; i < volume.size[0]; ++i) {
                const Vector3d p = volume.ct_from_voxel * Vector3d(i, j, k);
                volume.values.push_back(static_cast<float>(-1000 + 1040 * share(p.norm() - kSkin_mm) +
                                                           960 * share((p - kBoneCentre).norm() - bone_radius_mm)));
            }
    return volume;
}

/// The way from the skin along its inward normal until it meets the bone's crossing.
double true_thickness(const Vector3d& on_skin, const Vector3d& normal, double bone_radius_mm) {
    const Vector3d from = on_skin - kBoneCentre;
    const double along = from.dot(normal), across2 = from.squaredNorm() - along * along,
                 r = bone_radius_mm + kCrossing_mm;
    return along - std::sqrt(r * r - across2);
}

TEST(SkinThickness, OfABallIsTheWayToItsBone) {
    for (const double bone_mm : {63.0, 57.0, 45.0}) {
        const Volume volume = ball_with_bone(bone_mm);
        const TriangleMesh skin = triangulate_skin(volume, segment_skin(volume));
        ASSERT_EQ(skin.thickness_mm.size(), skin.vertices_in_ct.size());
        double sum2 = 0, worst = 0;
        for (std::size_t v = 0; v < skin.vertices_in_ct.size(); ++v) {
            ASSERT_FALSE(std::isnan(skin.thickness_mm[v]));
            const double error = static_cast<double>(skin.thickness_mm[v]) -
                                 true_thickness(skin.vertices_in_ct[v], skin.normals_in_ct[v], bone_mm);
            sum2 += error * error;
            worst = std::max(worst, std::abs(error));
        }
        // Between centres 1.3 to 1.5 mm apart straight lines lie above the foot of a profile of 0.8 mm blur, by up to
        // f'' h^2 / 8 = 100 HU where it rises by 400 HU/mm: bone is found up to 0.25 mm too early.
        EXPECT_LT(std::sqrt(sum2 / static_cast<double>(skin.vertices_in_ct.size())), 0.16) << bone_mm;
        EXPECT_LT(worst, 0.3) << bone_mm;
    }
}

TEST(SkinThickness, IsUnknownWhereNoBoneIsWithinReach) {
    const Volume volume = ball_with_bone(28);  // 42 mm deep, less 3.7 on the near side
    const TriangleMesh skin = triangulate_skin(volume, segment_skin(volume));
    std::size_t known = 0, wrong = 0;
    for (std::size_t v = 0; v < skin.vertices_in_ct.size(); ++v) {
        const double truth = true_thickness(skin.vertices_in_ct[v], skin.normals_in_ct[v], 28);
        const bool here = !std::isnan(skin.thickness_mm[v]);
        known += here;
        wrong += here != (truth < 40) && std::abs(truth - 40) > 0.35;
    }
    EXPECT_EQ(wrong, 0U);
    EXPECT_GT(known, skin.vertices_in_ct.size() / 20);
    EXPECT_LT(known, skin.vertices_in_ct.size() / 2);
}

/// A cone-beam CT's greys are HU only roughly: bone is where it is, whatever its grey.
TEST(SkinThickness, OfShiftedOrStretchedGreysIsTheSame) {
    Volume volume = ball_with_bone(45);
    std::mt19937 random(4);
    std::normal_distribution<float> noise(0, 20);
    for (float& v : volume.values) v += noise(random);
    const auto median_of = [](const Volume& of) {
        const SkinMask mask = segment_skin(of);
        std::vector<double> known;
        for (const float t : triangulate_skin(of, mask).thickness_mm)
            if (!std::isnan(t)) known.push_back(t);
        return known.size() < 1000 ? NAN : median(std::move(known));
    };
    const double truth = median_of(volume);
    EXPECT_NEAR(truth, 25, 1.5);
    for (const auto& [stretch, shift] : {std::pair(1.2F, 0.F), std::pair(0.7F, 0.F), std::pair(1.F, 200.F)}) {
        Volume grey = volume;
        for (float& v : grey.values) {
            const float body = (v + 1000) / 1040;  // what is no air moves whole, air stays
            v = -1000 + stretch * (v + 1000) + shift * std::clamp(body, 0.F, 1.F);
        }
        EXPECT_NEAR(median_of(grey), truth, 0.25) << stretch << ", " << shift;
    }
}

TEST(SkinThickness, IsEmptyWithoutHounsfieldUnits) {
    Volume volume = ball_with_bone(60);
    SkinSettings settings;
    settings.threshold = -480;
    const SkinMask mask = segment_skin(volume, settings);
    volume.is_hu = false;
    EXPECT_TRUE(triangulate_skin(volume, mask, settings).thickness_mm.empty());
    volume.is_hu = true;
    volume.modality = "MR";
    EXPECT_TRUE(triangulate_skin(volume, mask, settings).thickness_mm.empty());
}

TEST(SkinThickness, IsUnknownOnLidsAndCutPlanes) {
    const Volume volume = ball_with_bone(60);
    TriangleMesh skin = triangulate_skin(volume, segment_skin(volume));
    skin.flags[5] = kSeal;
    skin.flags[6] = kCutPlane;
    const std::vector<float> thickness = skin_thickness(volume, skin);
    EXPECT_TRUE(std::isnan(thickness[5]) && std::isnan(thickness[6]));
    EXPECT_FALSE(std::isnan(thickness[7]));
}

TEST(SkinThickness, ReachesTheTable) {
    const Volume volume = ball_with_bone(60);
    TriangleMesh skin = triangulate_skin(volume, segment_skin(volume));
    for (std::size_t v = 0; v < skin.thickness_mm.size(); ++v)
        if (skin.vertices_in_ct[v].z() > 50) skin.thickness_mm[v] = NAN;
    const SkinLut lut = build_skin_lut(skin);
    for (const auto& s : lut.skin) {
        if (s.position_in_ct.z() > 52) {
            EXPECT_TRUE(std::isnan(s.thickness_mm));
        }  // edges are below 2.2 mm
        if (s.position_in_ct.z() < 48) {
            ASSERT_NEAR(s.thickness_mm,
                        true_thickness(s.position_in_ct.cast<double>(), s.normal_in_ct.cast<double>(), 60), 0.4);
        }
    }
    skin.thickness_mm.clear();
    for (const auto& s : build_skin_lut(skin).skin) ASSERT_TRUE(std::isnan(s.thickness_mm));
}

}  // namespace
}  // namespace planlight::test
