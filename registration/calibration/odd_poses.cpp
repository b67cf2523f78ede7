#include "registration/calibration/odd_poses.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <utility>

namespace planlight {
namespace {

/// Poses that a device's other poses contradict: over half of what it saw there is left out.
std::vector<std::size_t> odd_poses(const BundleResult& bundle, DeviceName device) {
    constexpr std::size_t kLeast = 10;
    std::vector<std::size_t> odd;
    for (const PoseResidual& r : bundle.residuals)
        if (r.device == device && r.used + r.left_out >= kLeast && r.left_out > r.used) odd.push_back(r.pose);
    std::sort(odd.begin(), odd.end());
    return odd;
}

/// When a device that stood otherwise in these poses (at least one) was moved, as far as their place in the order says.
std::string when_moved(const std::vector<std::size_t>& odd, const std::vector<PoseObservation>& poses,
                       const RigEstimate& rig) {
    std::vector<std::size_t> seen;
    for (std::size_t i = 0; i < poses.size(); ++i)
        if (rig.rig_from_board[i]) seen.push_back(i);
    const std::size_t n = std::min(odd.size(), seen.size());
    if (std::equal(odd.begin(), odd.end(), seen.end() - static_cast<std::ptrdiff_t>(n), seen.end()))
        return "before " + poses[odd.front()].name;
    if (std::equal(odd.begin(), odd.end(), seen.begin(), seen.begin() + static_cast<std::ptrdiff_t>(n)))
        return "after " + poses[odd.back()].name;
    return odd.size() == 1 ? "for that pose" : "for those poses";
}

struct OddPoses {
    DeviceName device;
    std::vector<std::size_t> poses;
};

/// Of the first device that has some.
std::optional<OddPoses> odd_now(const BundleResult& bundle) {
    for (const DeviceName device : kDevices)
        if (bundle.rig.device(device))
            if (auto odd = odd_poses(bundle, device); !odd.empty()) return OddPoses{device, std::move(odd)};
    return std::nullopt;
}

/// Where they are several they draw the adjustment towards themselves, and only the worst shows: it is left out and the
/// others are asked again.
std::optional<OddPoses> all_odd_poses(const std::vector<PoseObservation>& poses, const BoardSpec& board,
                                      BundleResult bundle, const BundleSettings& settings) {
    const auto first = odd_now(bundle);
    if (!first) return std::nullopt;
    OddPoses all{first->device, {}};
    const std::size_t seen = bundle.rig.poses();
    for (auto odd = first; odd; odd = odd_now(bundle)) {
        for (const std::size_t pose : odd->poses) bundle.rig.rig_from_board[pose].reset();
        all.poses.insert(all.poses.end(), odd->poses.begin(), odd->poses.end());
        if (2 * bundle.rig.poses() <= seen) return first;  // which of them are odd is open
        bundle = adjust_bundle(poses, board, bundle.rig, settings);
        if (!bundle.converged) return first;
    }
    std::sort(all.poses.begin(), all.poses.end());
    return all;
}

}  // namespace

std::optional<Refusal> judge_odd_poses(const std::vector<PoseObservation>& poses, const BoardSpec& board,
                                       const BundleResult& bundle, const BundleSettings& settings) {
    const auto odd = all_odd_poses(poses, board, bundle, settings);
    if (!odd) return std::nullopt;
    std::vector<std::string> names;
    for (const std::size_t pose : odd->poses) names.push_back(poses[pose].name);
    const bool light = odd->device == DeviceName::projector;
    const char* them = names.size() == 1 ? "that pose" : "those poses";
    return Refusal{
        fmt::format("the {}'s {} of {} contradict{} the other poses': {} was moved {}, or its zoom or focus changed, "
                    "or the pictures of {} are bad",
                    text_of(odd->device), light ? "light" : "corners", fmt::join(names, ", "), light ? "s" : "",
                    light ? "the projector, or a camera," : "a camera", when_moved(odd->poses, poses, bundle.rig),
                    them),
        fmt::format("If every device stands now as it stood in the other poses, take {} out of the folder and "
                    "calibrate again; else fix all devices to the rig, and their zoom and focus, and capture all poses "
                    "again.",
                    fmt::join(names, ", "))};
}

}  // namespace planlight
