#include "segmentation/boneless_ends.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "planning_io/volume/volume_sample.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kBone_hu = 300;
constexpr double kStep_mm = 1.5, kUnder_mm = 25, kAround_mm = 150;
constexpr double kWithin_voxels = 0.75;  // from the end, half a voxel beyond the last voxel's middle
constexpr int kWays = 12;                // in the end's plane
constexpr double kSurrounded = 0.5;      // of the ways that meet bone
constexpr double kLowest = -0.25, kBehindFace = -0.5, kAboveFace = 0.2;  // of the skull's radius from its middle

class Ends {
public:
    Ends(const Volume& volume, const SkinMask& mask, double bone)
        : volume_(volume), mask_(mask), bone_(bone), voxel_from_ct_(volume.ct_from_voxel.inverse()) {}

    /// At a side of the volume, not where values were blanked within it.
    bool is_at_side(const Vector3d& p_in_ct) const {
        const Vector3d at = voxel_from_ct_ * p_in_ct;
        for (int a = 0; a < 3; ++a)
            if (at[a] < 1 || at[a] > volume_.size[static_cast<std::size_t>(a)] - 2) return true;
        return false;
    }

    bool is_boneless(const Vector3d& p_in_ct, const Vector3d& out_in_ct) const {
        const double voxel_mm = 1 / (voxel_from_ct_.linear() * out_in_ct).norm();
        const Vector3d within = p_in_ct - std::max(kStep_mm, kWithin_voxels * voxel_mm) * out_in_ct;
        if (meets_bone(within, -out_in_ct, kUnder_mm)) return false;
        const Vector3d u = out_in_ct.unitOrthogonal(), v = out_in_ct.cross(u);
        int met = 0;
        for (int way = 0; way < kWays; ++way) {
            const double turn = 2 * std::numbers::pi * way / kWays;
            met += meets_bone(within, std::cos(turn) * u + std::sin(turn) * v, kAround_mm);
        }
        return met < kSurrounded * kWays;
    }

private:
    /// On the way out of the body. What lies beyond the volume may be bone.
    bool meets_bone(const Vector3d& from_in_ct, const Vector3d& way, double longest_mm) const {
        for (double d = 0; d <= longest_mm; d += kStep_mm) {
            const Vector3d at = voxel_from_ct_ * (from_in_ct + d * way);
            const auto hu = value_at(volume_, at);
            if (!hu || *hu > bone_) return true;
            const Eigen::Vector3i voxel = at.array().round().cast<int>();
            if (!mask_.body[volume_.index(voxel.x(), voxel.y(), voxel.z())]) return false;
        }
        return false;
    }

    const Volume& volume_;
    const SkinMask& mask_;
    double bone_;  ///< a value that only bone has
    Eigen::Affine3d voxel_from_ct_;
};

}  // namespace

std::vector<std::uint8_t> boneless_ends(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin,
                                        const HeadBall& ball, const CtGreys& greys) {
    if (!volume.is_hu || skin.flags.empty()) return {};
    std::vector<std::uint8_t> boneless(skin.flags.size(), 0);
    const Ends ends(volume, mask, greys.of(kBone_hu));
    const double r = ball.radius_mm;
    tbb::parallel_for(std::size_t{0}, boneless.size(), [&](std::size_t v) {
        if (skin.flags[v] != kCutPlane) return;
        const Vector3d from = skin.vertices_in_ct[v] - ball.centre_in_ct;
        if (from.z() < kLowest * r || (from.y() < kBehindFace * r && from.z() < kAboveFace * r)) return;
        const Vector3d& p = skin.vertices_in_ct[v];
        boneless[v] = ends.is_at_side(p) && ends.is_boneless(p, skin.normals_in_ct[v]);
    });
    return boneless;
}

}  // namespace planlight
