#include "registration/calibration/board_stretch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "registration/calibration/camera_fits.h"

namespace planlight {
namespace {

/// The height of the board's squares over their width with which both cameras fit best together: the square of the
/// misfit is a parabola over it.
BoardSpec best_stretched(const std::vector<PoseObservation>& poses, BoardSpec board,
                         const CalibrationSettings& settings) {
    const auto misfit = [&](double stretch) {
        board.stretch = stretch;
        const BundleResult result = adjust_corners(poses, board, settings);
        return result.converged ? result.sigma_px[0] * result.sigma_px[0] + result.sigma_px[1] * result.sigma_px[1]
                                : std::numeric_limits<double>::quiet_NaN();
    };
    double best = board.stretch;
    for (const double step : {0.01, 0.0025, 0.001}) {
        const double below = misfit(best - step), here = misfit(best), above = misfit(best + step);
        const double bend = below + above - 2 * here;
        if (!(bend > 0)) break;
        best = std::clamp(best + step * (below - above) / (2 * bend), 0.9, 1.1);
    }
    board.stretch = best;
    return board;
}

}  // namespace

double board_stretch(const RigEstimate& rig) {
    constexpr double kAlike = 2;
    const auto &left = rig.device(DeviceName::left_camera), &right = rig.device(DeviceName::right_camera);
    if (!left || !right) return 0;
    const double a = 1 - left->focal_x / left->focal_y, b = 1 - right->focal_x / right->focal_y;
    return a * b > 0 && std::abs(a) < kAlike * std::abs(b) && std::abs(b) < kAlike * std::abs(a) ? (a + b) / 2 : 0;
}

std::string said_of_stretch(double stretch) {
    return fmt::format("both cameras see the board {:.1f} % {} than it should be", 100 * std::abs(stretch),
                       stretch > 0 ? "longer in its height" : "shorter in its height");
}

std::optional<Refusal> judge_stretch(const std::vector<PoseObservation>& poses, const BoardSpec& board,
                                     const BundleResult& cameras, const CalibrationSettings& s) {
    if (!cameras.rig.device(DeviceName::right_camera)) return std::nullopt;
    constexpr double kLeast = 0.001, kMuchBetter = 0.5;
    const BoardSpec stretched = best_stretched(poses, board, s);
    const BundleResult now = adjust_corners(poses, stretched, s);
    if (!cameras_fit(now, s) || std::abs(stretched.stretch - 1) < kLeast || worse_together(poses, stretched, now, s))
        return std::nullopt;
    for (const DeviceName camera : kCameras) {
        const auto c = static_cast<std::size_t>(camera);
        if (now.sigma_px[c] > kMuchBetter * cameras.sigma_px[c] + kResidualFloor_px) return std::nullopt;
    }
    return Refusal{said_of_stretch(stretched.stretch - 1), kStretchRemedy};
}

}  // namespace planlight
