#include "registration/simulation/serve/head_under_light.h"

#include <algorithm>

namespace planlight::simulation {

double lit_share(const RgbImage& picture) {
    constexpr int kLit = 16;  // a plan is dimmed in a dark room
    if (picture.pixels.empty()) return 0;
    const auto lit = std::count_if(picture.pixels.begin(), picture.pixels.end(), [](const Rgb& colour) {
        return *std::max_element(colour.begin(), colour.end()) >= kLit;
    });
    return static_cast<double>(lit) / static_cast<double>(picture.pixels.size());
}

Instant HeadUnderLight::show(const RgbImage& picture, Instant valid_until) {
    constexpr double kPlan = 0.1;
    const double lit = lit_share(picture), wanted = lit >= kPlan ? 0 : lit > 0 ? speed_mm_s_.load() : moves_at_mm_s_;
    if (wanted != moves_at_mm_s_) rig_.set_motion({wanted, rig_.clock().now()});
    moves_at_mm_s_ = wanted;
    return rig_.projector().show(picture, valid_until);
}

}  // namespace planlight::simulation
