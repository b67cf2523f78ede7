#include "registration/scan/movement/uniform_light_frames.h"

#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

using Kind = StripePattern::Kind;

}  // namespace

std::vector<UniformLightFrame> uniform_light_frames(const ScanCapture& capture) {
    const auto patterns = capture.partial.empty() ? stripe_sequence(capture.stripes) : capture.partial;
    std::vector<UniformLightFrame> moments;
    const auto add = [&](const std::vector<std::size_t>& which) {
        const double middle = 0.5 * static_cast<double>(which.front() + which.back());
        const auto last = static_cast<double>(std::max<std::size_t>(1, patterns.size() - 1));
        moments.push_back({patterns[which.front()].name, middle / last, which});
    };
    std::vector<std::size_t> fringes;
    for (std::size_t i = 0; i < patterns.size(); ++i) {
        const bool next = i + 1 < patterns.size();
        if (patterns[i].kind == Kind::white && next && patterns[i + 1].kind == Kind::black) add({i, i + 1});
        if (patterns[i].kind == Kind::gray_bit && next && patterns[i + 1].kind == Kind::gray_bit_inverse)
            add({i, i + 1});
        if (patterns[i].kind != Kind::phase) continue;
        fringes.push_back(i);
        if (next && patterns[i + 1].kind == Kind::phase && patterns[i + 1].along_rows == patterns[i].along_rows &&
            patterns[i + 1].frequency == patterns[i].frequency)
            continue;
        add(fringes);
        fringes.clear();
    }
    return moments;
}

std::vector<float> sum_uniform_light(const std::vector<GrayImage>& frames, const UniformLightFrame& moment) {
    std::vector<float> sum(frames.at(0).pixels.size(), 0);
    const float scale = 2.0F / static_cast<float>(moment.frames.size());
    for (const std::size_t k : moment.frames)
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += scale * static_cast<float>(frames.at(k).pixels[i]);
    return sum;
}

GrayImage half_uniform_light(const std::vector<GrayImage>& frames, const UniformLightFrame& moment) {
    const std::vector<float> picture = sum_uniform_light(frames, moment);
    GrayImage half(frames.at(0).width, frames.at(0).height);
    for (std::size_t i = 0; i < picture.size(); ++i)
        half.pixels[i] = static_cast<std::uint8_t>(std::clamp(std::lround(0.5F * picture[i]), 0L, 255L));
    return half;
}

}  // namespace planlight
