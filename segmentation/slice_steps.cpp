#include "segmentation/slice_steps.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "planning_io/types/statistics.h"

namespace planlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kSectors = 36;
constexpr double kStep_mm = 1;     // within a slice: finer pixels tell a sector's area no better
constexpr double kUpper_mm = 150;  // of the head: below lie neck and shoulders, whose outline is another
using Radii = Eigen::Matrix<double, kSectors, 1>;
using Columns = Eigen::Matrix<double, kSectors, 3>;

/// The slices across one axis of the volume.
class Slices {
public:
    Slices(const Volume& volume, const SkinMask& mask, double least_z_mm, int axis)
        : volume_(volume),
          mask_(mask),
          least_z_mm_(least_z_mm),
          across_(axis),
          u_((axis + 1) % 3),
          v_((axis + 2) % 3),
          spacing_mm_(volume.spacing_mm()),
          step_u_(std::max(1, static_cast<int>(std::lround(kStep_mm / spacing_mm_[u_])))),
          step_v_(std::max(1, static_cast<int>(std::lround(kStep_mm / spacing_mm_[v_])))) {
        find_middle();
        set_sectors();
        for (int k = 0; k < volume.size[static_cast<std::size_t>(axis)]; ++k) radii_.push_back(radii_of(k));
    }
    int count() const { return static_cast<int>(radii_.size()); }
    /// From the head's middle to its outline, by sectors: as large as a circle of the sector's area. Empty where the
    /// slice holds too little of the head.
    const std::optional<Radii>& radii(int slice) const { return radii_[static_cast<std::size_t>(slice)]; }
    Vector3d between_in_ct(int slice) const {
        Vector3d voxel;
        voxel[across_] = slice + 0.5;
        voxel[u_] = middle_mm_.x() / spacing_mm_[u_];
        voxel[v_] = middle_mm_.y() / spacing_mm_[v_];
        return volume_.ct_from_voxel * voxel;
    }
    Vector3d normal_in_ct() const {
        const Eigen::Matrix3d axes = volume_.ct_from_voxel.linear();
        return axes.col(u_).cross(axes.col(v_)).normalized();
    }
    Vector3d along_in_ct(const Vector2d& mm) const {
        const Eigen::Matrix3d axes = volume_.ct_from_voxel.linear();
        return axes.col(u_).normalized() * mm.x() + axes.col(v_).normalized() * mm.y();
    }

private:
    bool body(int slice, int i, int j) const {
        std::array<int, 3> at{};
        at[static_cast<std::size_t>(across_)] = slice;
        at[static_cast<std::size_t>(u_)] = i;
        at[static_cast<std::size_t>(v_)] = j;
        if (mask_.body[volume_.index(at[0], at[1], at[2])] == 0) return false;
        const auto& m = volume_.ct_from_voxel.matrix();
        return m(2, 0) * at[0] + m(2, 1) * at[1] + m(2, 2) * at[2] + m(2, 3) >= least_z_mm_;
    }
    /// Every place of a slice that is looked at, a millimetre apart.
    template <class Visit>
    void each_place(const Visit& visit) const {
        for (int j = 0; j < size(v_); j += step_v_)
            for (int i = 0; i < size(u_); i += step_u_) visit(i, j);
    }
    int size(int axis) const { return volume_.size[static_cast<std::size_t>(axis)]; }
    void find_middle() {
        double n = 0;
        Vector2d sum = Vector2d::Zero();
        areas_.assign(static_cast<std::size_t>(size(across_)), 0);
        for (int k = 0; k < size(across_); ++k)
            each_place([&](int i, int j) {
                if (body(k, i, j)) sum += Vector2d(i, j), ++n, ++areas_[static_cast<std::size_t>(k)];
            });
        middle_mm_ = (sum / std::max(n, 1.)).cwiseProduct(Vector2d(spacing_mm_[u_], spacing_mm_[v_]));
    }
    /// Which sector each place of a slice lies in.
    void set_sectors() {
        each_place([&](int i, int j) {
            const Vector2d p = Vector2d(i * spacing_mm_[u_], j * spacing_mm_[v_]) - middle_mm_;
            const double turn = std::atan2(p.y(), p.x()) / (2 * std::numbers::pi) + 0.5;
            sectors_.push_back(std::min(kSectors - 1, static_cast<int>(turn * kSectors)));
        });
    }
    std::optional<Radii> radii_of(int slice) const {
        constexpr double kLeastShare = 0.3, kLeastRadius_mm = 25;
        if (areas_[static_cast<std::size_t>(slice)] < kLeastShare * *std::max_element(areas_.begin(), areas_.end()))
            return std::nullopt;
        Radii voxels = Radii::Zero();
        std::size_t at = 0;
        each_place([&](int i, int j) {
            if (body(slice, i, j)) ++voxels[sectors_[at]];
            ++at;
        });
        const double place_mm2 = step_u_ * spacing_mm_[u_] * step_v_ * spacing_mm_[v_];
        const Radii radii = (voxels * (place_mm2 * kSectors / std::numbers::pi)).cwiseSqrt();
        if (radii.minCoeff() < kLeastRadius_mm) return std::nullopt;
        return radii;
    }

    const Volume& volume_;
    const SkinMask& mask_;
    double least_z_mm_;
    int across_, u_, v_;
    Vector3d spacing_mm_;
    int step_u_, step_v_;  ///< voxels
    Vector2d middle_mm_ = Vector2d::Zero();
    std::vector<double> areas_;  ///< of each slice, places
    std::vector<int> sectors_;
    std::vector<std::optional<Radii>> radii_;
};

/// A shift and a turn of the whole outline.
struct Jump {
    int slice = 0;
    Vector3d by = Vector3d::Zero();  ///< mm, mm, radians
    double rms_mm = 0;               ///< of what they explain
    double left_mm = 0;              ///< of what they do not
};

/// How an outline changes when it is shifted by a millimetre, and turned by a radian.
Columns columns_of(const Radii& radii) {
    Columns columns;
    for (int s = 0; s < kSectors; ++s) {
        const double angle = ((s + 0.5) / kSectors - 0.5) * 2 * std::numbers::pi;
        const double slope =
            (radii[(s + 1) % kSectors] - radii[(s + kSectors - 1) % kSectors]) / (4 * std::numbers::pi / kSectors);
        columns.row(s) << std::cos(angle) + slope / radii[s] * std::sin(angle),
            std::sin(angle) - slope / radii[s] * std::cos(angle), -slope;
    }
    return columns;
}

std::optional<Jump> jump_after(const Slices& slices, int k) {
    constexpr int kBeside = 2;
    std::vector<Radii> others;
    for (int i = k - kBeside; i <= k + kBeside; ++i) {
        if (i < 0 || i + 1 >= slices.count() || !slices.radii(i) || !slices.radii(i + 1)) return std::nullopt;
        if (i != k) others.emplace_back(*slices.radii(i + 1) - *slices.radii(i));
    }
    Radii jump = *slices.radii(k + 1) - *slices.radii(k);
    for (int s = 0; s < kSectors; ++s) {  // the middle two of the four beside it: how the head goes on there
        std::array<double, 4> change{others[0][s], others[1][s], others[2][s], others[3][s]};
        std::sort(change.begin(), change.end());
        jump[s] -= (change[1] + change[2]) / 2;
    }
    const Columns columns = columns_of(*slices.radii(k));
    Radii weight = Radii::Ones();
    Jump found{k, {}, 0, 0};
    for (int round = 0; round < 6; ++round) {  // robust: an ear is a few sectors
        found.by = (columns.transpose() * weight.asDiagonal() * columns + 1e-9 * Eigen::Matrix3d::Identity())
                       .ldlt()
                       .solve(columns.transpose() * weight.asDiagonal() * jump);
        const Radii left = (jump - columns * found.by).cwiseAbs();
        weight = (left.array() + 0.1).inverse();
    }
    found.rms_mm = std::sqrt((columns * found.by).squaredNorm() / kSectors);
    const Radii left = jump - columns * found.by;
    std::vector<double> sizes;
    for (int s = 0; s < kSectors; ++s) sizes.push_back(std::abs(left[s]));
    found.left_mm = 1.4826 * median(std::move(sizes));
    return found;
}

}  // namespace

std::optional<SliceStep> largest_slice_step(const Volume& volume, const SkinMask& mask, const HeadBall& ball) {
    constexpr double kLeast_mm = 0.6, kUsual = 6, kExplained = 2.5;
    constexpr std::size_t kLeastSlices = 12;
    std::optional<SliceStep> largest;
    for (int axis = 0; axis < 3; ++axis) {
        const Slices slices(volume, mask, ball.centre_in_ct.z() + ball.radius_mm - kUpper_mm, axis);
        std::vector<Jump> jumps;
        std::vector<double> sizes;
        for (int k = 0; k + 1 < slices.count(); ++k)
            if (auto jump = jump_after(slices, k)) jumps.push_back(*jump), sizes.push_back(jump->rms_mm);
        if (jumps.size() < kLeastSlices) continue;
        const double usual_mm = median(std::move(sizes));
        for (const Jump& jump : jumps) {
            if (jump.rms_mm < std::max(kLeast_mm, kUsual * usual_mm) || jump.rms_mm < kExplained * jump.left_mm)
                continue;
            if (largest && largest->jump_mm >= jump.rms_mm) continue;
            largest = SliceStep{slices.between_in_ct(jump.slice),
                                slices.normal_in_ct(),
                                slices.along_in_ct(jump.by.head<2>()),
                                jump.by.head<2>().norm(),
                                jump.by[2],
                                jump.rms_mm,
                                usual_mm};
        }
    }
    return largest;
}

}  // namespace planlight
