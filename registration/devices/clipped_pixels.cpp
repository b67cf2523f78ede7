#include "registration/devices/clipped_pixels.h"

#include <algorithm>

namespace planlight {

ClippedShares clipped_shares(const GrayImage& picture) {
    if (picture.empty()) return {};
    const auto all = static_cast<double>(picture.pixels.size());
    const auto share = [&](auto is) {
        return static_cast<double>(std::count_if(picture.pixels.begin(), picture.pixels.end(), is)) / all;
    };
    return {share([](std::uint8_t grey) { return grey >= kTooBright_grey; }),
            share([](std::uint8_t grey) { return grey < kTooDark_grey; })};
}

}  // namespace planlight
