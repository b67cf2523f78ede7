#include "registration/tracking/picture_jumps.h"

#include "planning_io/types/statistics.h"

namespace planlight {
namespace {

using Eigen::Vector2d;

/// The median step of the discs that are found again near where the last step would bring them.
std::optional<Vector2d> common_step(const std::vector<Vector2d>& before, const std::vector<Vector2d>& now,
                                    const Vector2d& expected) {
    constexpr double kReach_px = 25;
    constexpr std::size_t kLeast = 3;
    std::vector<double> x, y;
    for (const Vector2d& p : before) {
        const Vector2d* nearest = nullptr;
        for (const Vector2d& q : now)
            if (!nearest || (q - p - expected).norm() < (*nearest - p - expected).norm()) nearest = &q;
        if (!nearest || (*nearest - p - expected).norm() > kReach_px) continue;
        x.push_back((*nearest - p).x());
        y.push_back((*nearest - p).y());
    }
    if (x.size() < kLeast) return std::nullopt;
    return Vector2d(median(std::move(x)), median(std::move(y)));
}

}  // namespace

std::optional<double> PictureJumps::Side::add(const std::vector<PatientTracker::Seen>& seen, double mm_per_px) {
    std::vector<Vector2d> now;
    for (const auto& s : seen) now.push_back(s.left_or_right.pixel);
    const auto went = common_step(discs, now, step.value_or(Vector2d::Zero()));
    std::optional<double> jump_mm;
    if (went && step) jump_mm = mm_per_px * (*went - *step).norm();
    constexpr double kJump_mm = 0.2;
    const bool jumps = jump_mm && *jump_mm > kJump_mm && !jumped;
    // After a jump the movement goes on as it was before: it is no velocity.
    if (!jumps) step = went;
    if (jumped) jump_mm.reset();
    jumped = jumps;
    discs = std::move(now);
    return jump_mm;
}

std::array<std::optional<double>, 2> PictureJumps::add(const std::vector<PatientTracker::Seen>& left,
                                                       const std::vector<PatientTracker::Seen>& right,
                                                       double depth_mm) {
    return {sides_[0].add(left, depth_mm / rig_.left_camera.focal_x),
            sides_[1].add(right, depth_mm / rig_.right_camera.focal_x)};
}

void PictureJumps::reset() {
    sides_ = {};
}

}  // namespace planlight
