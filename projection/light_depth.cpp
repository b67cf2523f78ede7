#include "projection/light_depth.h"

#include <algorithm>
#include <cmath>

#include "planning_io/types/statistics.h"

namespace planlight {

double sideways_slope(const SeenSegment& segment, const Eigen::Vector3d& centre_in_ct) {
    const Eigen::Vector3d way = centre_in_ct - segment.p_in_ct;
    return way.dot(segment.sideways_in_ct) / way.dot(segment.normal_in_ct);
}

std::optional<LightDepth> fit_depth(const std::vector<SeenDepth>& seen) {
    constexpr int kRounds = 5;
    constexpr double kHuber = 1.5, kLeastSlopes = 0.15;
    std::vector<double> each;
    for (const SeenDepth& s : seen)
        if (std::abs(s.slopes) > kLeastSlopes) each.push_back(s.apart_mm / s.slopes);
    if (each.empty()) return std::nullopt;
    LightDepth depth{median(std::move(each)), 0};
    for (int round = 0; round < kRounds; ++round) {
        double information = 0, right = 0;
        for (const SeenDepth& s : seen) {
            const double off = std::abs(s.apart_mm - depth.mm * s.slopes) / s.sigma_mm;
            const double w = (off < kHuber ? 1 : kHuber / off) / (s.sigma_mm * s.sigma_mm);
            information += w * s.slopes * s.slopes;
            right += w * s.apart_mm * s.slopes;
        }
        if (!(information > 0)) return std::nullopt;
        depth = {right / information, 1 / std::sqrt(information)};
    }
    return depth;
}

bool told_well(const LightDepth& depth) {
    constexpr double kWorst_mm = 0.25;
    return depth.sigma_mm <= kWorst_mm;
}

double aside_by_untold_height_mm(const std::vector<SeenAside>& seen, const std::optional<LightDepth>& depth) {
    constexpr double kMost_mm = 3, kHidden_mm = 0.4;
    double height_mm = depth ? std::min(kMost_mm, std::abs(depth->mm) + 3 * depth->sigma_mm) : kMost_mm;
    double steepest = 0;
    for (const SeenAside& s : seen) {
        steepest = std::max(steepest, std::abs(s.projector_slope));
        const double slopes = std::abs(s.projector_slope - s.camera_slope);
        if (slopes * height_mm > std::abs(s.off_mm) + kHidden_mm)
            height_mm = (std::abs(s.off_mm) + kHidden_mm) / slopes;
    }
    return height_mm * steepest;
}

}  // namespace planlight
