#include "registration/scan/check/sequence_samples.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "planning_io/types/statistics.h"
#include "registration/scan/check/picture_noise.h"

namespace planlight::sequence {
namespace {

constexpr std::size_t kSample = 16000;

void sort_frames(std::span<const GrayImage> frames, Samples& s) {
    if (frames.size() != s.patterns.size())
        throw std::invalid_argument(
            fmt::format("check_sequence: {} frames for {} pictures", frames.size(), s.patterns.size()));
    for (const GrayImage& f : frames)
        if (f.width != frames[0].width || f.pixels.size() != frames[0].pixels.size() || f.empty())
            throw std::invalid_argument("check_sequence: frames of different size");
    for (const auto kind : {StripePattern::Kind::white, StripePattern::Kind::black})
        if (std::none_of(s.patterns.begin(), s.patterns.end(), [&](const StripePattern& p) { return p.kind == kind; }))
            throw std::invalid_argument("check_sequence: no white or no black frame");
    for (Direction& direction : s.directions) direction.further.resize(s.stripes.order_periods_px.size());
    for (std::size_t i = 0; i < frames.size(); ++i) {
        Direction& direction = s.directions[s.patterns[i].along_rows ? 1 : 0];
        switch (s.patterns[i].kind) {
            case StripePattern::Kind::white:
                s.white = i;
                break;
            case StripePattern::Kind::black:
                s.black = i;
                break;
            case StripePattern::Kind::gray_bit:
                direction.gray.push_back(i);
                break;
            case StripePattern::Kind::gray_bit_inverse:
                direction.inverse.push_back(i);
                break;
            case StripePattern::Kind::phase:
                direction.fringes(s.patterns[i].frequency).push_back(i);
                break;
        }
    }
}

/// A sample of the pixels, away from the picture's rim: short runs (they share what is fetched of each frame), one a
/// square, at places in it that follow no pattern, for the stripes do.
std::vector<std::size_t> sample_of(const GrayImage& picture) {
    constexpr int kRun = 4, kStep_px = 4;
    const double squares = static_cast<double>(kSample) / kRun;
    const int side = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(picture.pixels.size()) / squares)));
    std::uint32_t random = 1;
    std::vector<std::size_t> pixels;
    for (int top = 0; top < picture.height; top += side)
        for (int left = 0; left < picture.width; left += side) {
            random = random * 1664525u + 1013904223u;
            const int y = top + static_cast<int>(random >> 20) % side,
                      x = left + static_cast<int>((random >> 8) & 4095u) % side;
            if (y < kFlat_px || y >= picture.height - kFlat_px) continue;
            for (int k = 0; k < kRun; ++k)
                if (const int at = x + k * kStep_px; at >= kFlat_px && at < picture.width - kFlat_px)
                    pixels.push_back(picture.index(at, y));
        }
    return pixels;
}

/// Frame by frame, and asked for ahead: what is waited for is the memory.
Bytes values_at(const GrayImage& frame, const std::vector<std::size_t>& pixels, std::ptrdiff_t shift) {
    constexpr std::size_t kAhead = 256, kLine = 4;
    const std::size_t n = pixels.size();
    Bytes values(n);
    const std::uint8_t* picture = frame.pixels.data() + shift;
    const std::size_t* place = pixels.data();
    std::uint8_t* out = values.data();
    for (std::size_t i = 0; i < std::min(n, kAhead); i += kLine) __builtin_prefetch(picture + place[i]);
    for (std::size_t begin = 0; begin < n; begin += kLine) {
        if (begin + kAhead < n) __builtin_prefetch(picture + place[begin + kAhead]);
        for (std::size_t i = begin; i < std::min(n, begin + kLine); ++i) out[i] = picture[place[i]];
    }
    return values;
}

/// Leaves out the pixels that show no light in white, black and the first pictures after them: most of a picture is not
/// lit, and were one of these the wrong frame, the others would still show the light.
void leave_out_dark(std::span<const GrayImage> frames, const Samples& s, std::vector<std::size_t>& pixels) {
    constexpr std::size_t kFirst = 8;
    Bytes low = values_at(frames[s.white], pixels, 0), high = low;
    const auto add = [&](const GrayImage& frame) {
        const Bytes values = values_at(frame, pixels, 0);
        for (std::size_t i = 0; i < values.size(); ++i) {
            low[i] = std::min(low[i], values[i]);
            high[i] = std::max(high[i], values[i]);
        }
    };
    add(frames[s.black]);
    for (std::size_t f = 0; f < std::min(kFirst, frames.size()); ++f)
        if (f != s.white && f != s.black) add(frames[f]);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i)
        if (high[i] - low[i] >= kLit_grey) pixels[kept++] = pixels[i];
    pixels.resize(kept);
}

/// How much of a change is light and not noise: more than noise makes of fifty frames. Never more than half of the
/// change of the best lit places (one in a hundred): with white or black out of its place the noise is not known.
int least_change(const Bytes& low, const Bytes& high, double dark_noise_grey) {
    std::vector<int> changes;
    for (std::size_t i = 0; i < low.size(); ++i)
        if (high[i] - low[i] >= kLit_grey) changes.push_back(high[i] - low[i]);
    if (changes.empty()) return kLit_grey;
    const auto strong = changes.begin() + static_cast<std::ptrdiff_t>(changes.size() * 99 / 100);
    std::nth_element(changes.begin(), strong, changes.end());
    return std::max(kLit_grey, std::min(static_cast<int>(6 * dark_noise_grey), *strong / 2));
}

/// What is never brighter than this is dark beside the best lit places, and its noise that of the dark.
int dark_level(const Bytes& high) {
    constexpr double kBest = 0.99;
    constexpr int kShare = 3;
    return quantile(high, kBest) / kShare;
}

/// Beside a bright stripe a camera that sharpens its pictures makes the dark darker than black: in one or two of fifty
/// frames. Were black another picture, or brighter than it should be, a tenth of them and more would be darker.
bool darker_in_many(const Samples& s, std::size_t i, int than) {
    const auto darker =
        std::count_if(s.here.begin(), s.here.end(), [&](const Bytes& frame) { return frame[i] < than; });
    return 10 * static_cast<std::size_t>(darker) > s.here.size();
}

/// White must be the brightest frame and black the darkest wherever any light changes. The places in the list of those
/// that are lit so, and neither too dark nor too bright to judge a sum by.
std::vector<std::size_t> choose_lit(Samples& s) {
    Bytes low = s.here[0], high = low;
    for (const Bytes& frame : s.here)
        for (std::size_t i = 0; i < frame.size(); ++i) {
            low[i] = std::min(low[i], frame[i]);
            high[i] = std::max(high[i], frame[i]);
        }
    std::vector<std::size_t> lit;
    s.least_change = least_change(low, high, s.dark_noise_grey);
    // Clipped at nothing and amplified, such noise has longer tails than a normal one.
    constexpr double kTails = 8;
    const int dark = dark_level(high),
              least_in_dark = std::max(s.least_change, static_cast<int>(kTails * s.dark_noise_grey));
    for (std::size_t i = 0; i < low.size(); ++i) {
        if (high[i] - low[i] < (high[i] < dark ? least_in_dark : s.least_change)) continue;
        ++s.changing;
        const int allowed = std::max((high[i] - low[i]) / 3, static_cast<int>(4 * s.noise_grey)),
                  white = s.here[s.white][i], black = s.here[s.black][i];
        const bool is_white = high[i] - white <= allowed,
                   is_black = black - low[i] <= allowed || !darker_in_many(s, i, black - allowed);
        s.not_white += !is_white;
        s.dark_white += !is_white && white - low[i] <= allowed;
        s.not_black += !is_black;
        if (is_white && is_black && white - black >= kLit_grey && white < kBright_grey) lit.push_back(i);
    }
    return lit;
}

void keep_lit(const std::vector<std::size_t>& lit, std::vector<std::size_t>& pixels, Samples& s) {
    for (Bytes& frame : s.here) {
        for (std::size_t i = 0; i < lit.size(); ++i) frame[i] = frame[lit[i]];
        frame.resize(lit.size());
    }
    for (std::size_t i = 0; i < lit.size(); ++i) pixels[i] = pixels[lit[i]];
    pixels.resize(lit.size());
    s.lit = lit.size();
}

std::vector<std::int16_t> contrast_of(const Bytes& white, const Bytes& black) {
    std::vector<std::int16_t> contrast(white.size());
    for (std::size_t i = 0; i < white.size(); ++i) contrast[i] = static_cast<std::int16_t>(white[i] - black[i]);
    return contrast;
}

}  // namespace

Samples gather_samples(std::span<const GrayImage> frames, const StripeSettings& stripes,
                       std::vector<StripePattern> patterns) {
    Samples s;
    s.patterns = std::move(patterns);
    s.stripes = stripes;
    sort_frames(frames, s);
    std::vector<std::size_t> pixels = sample_of(frames[0]);
    leave_out_dark(frames, s, pixels);
    for (const GrayImage& frame : frames) s.here.push_back(values_at(frame, pixels, 0));
    s.noise_grey = std::max(kNoise_grey, noise_in_light(frames[s.white], frames[s.black]));
    s.dark_noise_grey = noise_in_dark(frames[s.white], frames[s.black]);
    keep_lit(choose_lit(s), pixels, s);
    s.around.resize(frames.size());
    const std::ptrdiff_t line = std::ptrdiff_t{frames[0].width} * kFlat_px;
    for (std::size_t f = 0; f < frames.size(); ++f) {
        if (s.patterns[f].kind == StripePattern::Kind::phase) continue;
        const std::array<std::ptrdiff_t, 4> shifts{-kFlat_px, kFlat_px, -line, line};
        for (std::size_t k = 0; k < 4; ++k) s.around[f][k] = values_at(frames[f], pixels, shifts[k]);
    }
    s.contrast = contrast_of(s.here[s.white], s.here[s.black]);
    s.contrast_right = contrast_of(s.around[s.white][1], s.around[s.black][1]);
    s.contrast_below = contrast_of(s.around[s.white][3], s.around[s.black][3]);
    return s;
}

}  // namespace planlight::sequence
