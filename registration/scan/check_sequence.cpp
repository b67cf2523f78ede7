#include "registration/scan/check_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <stdexcept>

namespace planlight {
namespace {

constexpr int kLit_grey = 16;         // white - black of a pixel to look at
constexpr int kBright_grey = 250;     // above it a sum says nothing
constexpr int kFlat_px = 3;           // as far a pixel's neighbours must agree with it: no edge, no blur
constexpr double kNoise_grey = 2;     // of one frame; what else is allowed goes with the contrast
constexpr std::size_t kSample = 16000, kEnough = 200;

/// The frames of one direction, by place in the sequence.
struct Direction {
    std::vector<std::size_t> gray, inverse, phase;
};

struct Capture {
    std::span<const GrayImage> frames;
    std::vector<StripePattern> sequence;
    const StripeSettings& stripes;
    std::size_t white = 0, black = 1;
    std::array<Direction, 2> directions;
    std::vector<std::size_t> lit;  ///< pixels to look at; kFlat_px from the rim or more

    int at(std::size_t frame, std::size_t pixel) const { return frames[frame].pixels[pixel]; }
    int contrast(std::size_t pixel) const { return at(white, pixel) - at(black, pixel); }
    /// How clearly a bit is set (above 0) or not: against its inverse, or against the middle of white and black.
    int difference(const Direction& direction, std::size_t bit, std::size_t pixel) const {
        if (!direction.inverse.empty()) return at(direction.gray[bit], pixel) - at(direction.inverse[bit], pixel);
        return 2 * at(direction.gray[bit], pixel) - at(white, pixel) - at(black, pixel);
    }
    const std::string& name(std::size_t frame) const { return sequence[frame].name; }
};

Capture sorted(std::span<const GrayImage> frames, const StripeSettings& stripes) {
    Capture capture{frames, stripe_sequence(stripes), stripes, 0, 1, {}, {}};
    if (frames.size() != capture.sequence.size())
        throw std::invalid_argument(
            fmt::format("check_sequence: {} frames for {} pictures", frames.size(), capture.sequence.size()));
    for (const GrayImage& f : frames)
        if (f.width != frames[0].width || f.pixels.size() != frames[0].pixels.size() || f.empty())
            throw std::invalid_argument("check_sequence: frames of different size");
    for (std::size_t i = 0; i < frames.size(); ++i) {
        Direction& direction = capture.directions[capture.sequence[i].along_rows ? 1 : 0];
        switch (capture.sequence[i].kind) {
            case StripePattern::Kind::white: capture.white = i; break;
            case StripePattern::Kind::black: capture.black = i; break;
            case StripePattern::Kind::gray_bit: direction.gray.push_back(i); break;
            case StripePattern::Kind::gray_bit_inverse: direction.inverse.push_back(i); break;
            case StripePattern::Kind::phase: direction.phase.push_back(i); break;
        }
    }
    return capture;
}

/// Calls `visit(pixel)` for a sample of the pixels, away from the picture's rim: short runs (they share what is fetched of
/// each frame), one a square, at places in it that follow no pattern, for the stripes do.
template <class Visit>
void for_sample(const GrayImage& picture, const Visit& visit) {
    constexpr int kRun = 4, kStep_px = 4;
    const double squares = static_cast<double>(kSample) / kRun;
    const int side = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(picture.pixels.size()) / squares)));
    std::uint32_t random = 1;
    for (int top = 0; top < picture.height; top += side)
        for (int left = 0; left < picture.width; left += side) {
            random = random * 1664525u + 1013904223u;
            const int y = top + static_cast<int>(random >> 20) % side, x = left + static_cast<int>((random >> 8) & 4095u) % side;
            if (y < kFlat_px || y >= picture.height - kFlat_px) continue;
            for (int k = 0; k < kRun; ++k)
                if (const int at = x + k * kStep_px; at >= kFlat_px && at < picture.width - kFlat_px) visit(picture.index(at, y));
        }
}

double share_of(std::size_t part, std::size_t all) { return all == 0 ? 0 : static_cast<double>(part) / static_cast<double>(all); }

/// White must be the brightest frame and black the darkest wherever any light changes; the rest needs them.
void check_ends(Capture& capture, SequenceCheck& check) {
    std::size_t changing = 0, not_white = 0, not_black = 0;
    for_sample(capture.frames[0], [&](std::size_t pixel) {
        int low = 255, high = 0;
        for (std::size_t i = 0; i < capture.frames.size(); ++i) {
            low = std::min(low, capture.at(i, pixel));
            high = std::max(high, capture.at(i, pixel));
        }
        if (high - low < kLit_grey) return;
        ++changing;
        const int allowed = (high - low) / 3;
        const bool white = high - capture.at(capture.white, pixel) <= allowed,
                   black = capture.at(capture.black, pixel) - low <= allowed;
        not_white += !white;
        not_black += !black;
        if (white && black && capture.contrast(pixel) >= kLit_grey && capture.at(capture.white, pixel) < kBright_grey)
            capture.lit.push_back(pixel);
    });
    check.pixels = changing;
    check.checked = changing >= kEnough;
    constexpr double kMost = 0.05;
    if (check.checked && share_of(not_white, changing) > kMost)
        check.problems.push_back({capture.white, "white is not the brightest", share_of(not_white, changing)});
    if (check.checked && share_of(not_black, changing) > kMost)
        check.problems.push_back({capture.black, "black is not the darkest", share_of(not_black, changing)});
}

/// Whether a pixel's neighbours in all four directions have the same difference of two frames.
bool flat(const Capture& capture, std::size_t a, std::size_t b, std::size_t pixel) {
    const auto difference = [&](std::size_t p) { return capture.at(a, p) - capture.at(b, p); };
    const int here = difference(pixel), allowed = capture.contrast(pixel) / 4 + 4;
    const auto line = static_cast<std::size_t>(capture.frames[0].width) * kFlat_px;
    for (const std::size_t p : {pixel - kFlat_px, pixel + kFlat_px, pixel - line, pixel + line})
        if (std::abs(difference(p) - here) > allowed) return false;
    return true;
}

/// Another frame that looks just like this one although its picture is another; what happened, in words.
std::string explain(const Capture& capture, std::size_t frame) {
    std::optional<std::size_t> twin;
    double best = 0.02;
    for (std::size_t other = 0; other < capture.frames.size(); ++other) {
        if (other == frame) continue;
        std::size_t differ = 0;
        for (const std::size_t pixel : capture.lit)
            differ +=
                std::abs(capture.at(frame, pixel) - capture.at(other, pixel)) > capture.contrast(pixel) / 6 + 4 * kNoise_grey;
        if (const double share = share_of(differ, capture.lit.size()); share < best) {
            best = share;
            twin = other;
        }
    }
    return twin ? fmt::format("; {} looks like {}", capture.name(frame), capture.name(*twin)) : "";
}

void check_pairs(const Capture& capture, const Direction& direction, SequenceCheck& check) {
    for (std::size_t k = 0; k < direction.inverse.size(); ++k) {
        const std::size_t gray = direction.gray[k], inverse = direction.inverse[k];
        std::size_t looked = 0, wrong = 0;
        for (const std::size_t pixel : capture.lit) {
            if (!flat(capture, gray, inverse, pixel)) continue;
            ++looked;
            const int sum = capture.at(gray, pixel) + capture.at(inverse, pixel);
            const int wanted = capture.at(capture.white, pixel) + capture.at(capture.black, pixel);
            wrong += std::abs(sum - wanted) > 0.35 * capture.contrast(pixel) + 4 * kNoise_grey;
        }
        constexpr double kMost = 0.02;
        if (looked < kEnough || share_of(wrong, looked) <= kMost) continue;
        check.problems.push_back({gray, fmt::format("{} and its inverse do not complete each other{}{}", capture.name(gray),
                                                    explain(capture, gray), explain(capture, inverse)), share_of(wrong, looked)});
    }
}

/// Amplitude, phase and what is left over of the fringes at a pixel.
struct Fringe {
    double amplitude = 0, phase = 0;  ///< phase of the shift at the crest, radians
    double residual_grey = 0;         ///< rms by degree of freedom of what a fringe and its second harmonic cannot make
};
/// The fringes at all lit pixels; empty where there are none.
std::vector<Fringe> fringes_of(const Capture& capture, const std::vector<std::size_t>& phases) {
    if (phases.size() < 3) return {};
    const auto n = static_cast<double>(phases.size());
    std::vector<std::array<double, 4>> weights;
    for (std::size_t k = 0; k < phases.size(); ++k) {
        const double shift = 2 * std::numbers::pi * static_cast<double>(k) / n;
        weights.push_back(
            {std::sin(shift) * 2 / n, std::cos(shift) * 2 / n, std::sin(2 * shift) * 2 / n, std::cos(2 * shift) * 2 / n});
    }
    std::vector<Fringe> fringes;
    fringes.reserve(capture.lit.size());
    for (const std::size_t pixel : capture.lit) {
        double mean = 0, squares = 0;
        std::array<double, 4> sum{};  // sine and cosine of the first and second harmonic
        for (std::size_t k = 0; k < phases.size(); ++k) {
            const double value = capture.at(phases[k], pixel);
            mean += value / n;
            squares += value * value;
            for (std::size_t h = 0; h < 4; ++h) sum[h] += weights[k][h] * value;
        }
        Fringe fringe{std::hypot(sum[0], sum[1]), std::atan2(sum[0], sum[1]), 0};
        const double in_phase = sum[3] * std::cos(2 * fringe.phase) + sum[2] * std::sin(2 * fringe.phase);
        const double modelled = n * mean * mean + n / 2 * (fringe.amplitude * fringe.amplitude + in_phase * in_phase);
        fringe.residual_grey = std::sqrt(std::max(0.0, squares - modelled) / std::max(1.0, n - 4));
        fringes.push_back(fringe);
    }
    return fringes;
}

void check_fringes(const Capture& capture, const Direction& direction, const std::vector<Fringe>& fringes, SequenceCheck& check) {
    if (direction.phase.size() < 5) return;  // too few for anything to be left over
    const std::size_t looked = capture.lit.size();
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < looked; ++i) {
        const Fringe& fringe = fringes[i];
        // Out of order frames may leave hardly any fringe: what a fringe of this light can have is its measure.
        const double strength = std::max(fringe.amplitude, 0.25 * capture.contrast(capture.lit[i]));
        wrong += fringe.residual_grey > 0.12 * strength + 2 * kNoise_grey;
    }
    constexpr double kMost = 0.12;
    if (looked < kEnough || share_of(wrong, looked) <= kMost) return;
    std::string twins;  // which frame it is, where that can be seen
    for (const std::size_t frame : direction.phase) twins += explain(capture, frame);
    check.problems.push_back({direction.phase[0],
                              fmt::format("{} to {} are no fringes in order{}", capture.name(direction.phase.front()),
                                          capture.name(direction.phase.back()), twins),
                              share_of(wrong, looked)});
}

/// A Gray code's number is odd where an odd number of its bits is set; the fringe says the same of its two halves.
void check_parity(const Capture& capture, const Direction& direction, const std::vector<Fringe>& fringes, SequenceCheck& check) {
    if (direction.phase.size() < 3 || direction.gray.empty()) return;
    const double half_px = capture.stripes.phase_period_px / 2;
    std::size_t looked = 0, wrong = 0;
    for (std::size_t i = 0; i < capture.lit.size(); ++i) {
        const std::size_t pixel = capture.lit[i];
        const Fringe& fringe = fringes[i];
        if (fringe.amplitude < 0.1 * capture.contrast(pixel) + 2 * kNoise_grey) continue;
        const double pixel_in_period = fringe.phase * half_px / std::numbers::pi + 0.5;  // from the edge of pixel 0
        const double cell = std::floor(pixel_in_period / half_px), in_cell = pixel_in_period / half_px - cell;
        if (in_cell < 0.3 || in_cell > 0.7) continue;  // near its borders a bit may go either way
        bool odd = false, clear = true;
        for (std::size_t k = 0; k < direction.gray.size(); ++k) {
            const int difference = capture.difference(direction, k, pixel);
            clear = clear && 3 * std::abs(difference) > capture.contrast(pixel);
            odd ^= difference > 0;
        }
        if (!clear) continue;
        ++looked;
        wrong += odd != (static_cast<int>(cell) % 2 != 0);
    }
    constexpr double kMost = 0.03;
    if (looked < kEnough || share_of(wrong, looked) <= kMost) return;
    check.problems.push_back({direction.gray[0],
                              fmt::format("the code of {} to {} contradicts {} to {}", capture.name(direction.gray.front()),
                                          capture.name(direction.gray.back()), capture.name(direction.phase.front()),
                                          capture.name(direction.phase.back())),
                              share_of(wrong, looked)});
}

/// Of two bits the finer one changes more often: looked for between pixels and their neighbours to the right and below.
void check_order(const Capture& capture, const Direction& direction, SequenceCheck& check) {
    if (direction.gray.empty()) return;
    const auto line = static_cast<std::size_t>(capture.frames[0].width) * kFlat_px;
    std::vector<double> changes;
    std::vector<bool> resolved;  // a bit too fine for the optics changes where noise will
    std::size_t looked = 0;
    for (std::size_t k = 0; k < direction.gray.size(); ++k) {
        std::size_t changed = 0, clear = 0;
        looked = 0;
        for (const std::size_t pixel : capture.lit) {
            clear += 2 * std::abs(capture.difference(direction, k, pixel)) > capture.contrast(pixel);
            for (const std::size_t next : {pixel + kFlat_px, pixel + line}) {
                if (capture.contrast(next) < kLit_grey) continue;
                const int here = capture.difference(direction, k, pixel), there = capture.difference(direction, k, next);
                ++looked;
                changed += (here > 0) != (there > 0) && std::min(std::abs(here), std::abs(there)) * 4 > capture.contrast(pixel);
            }
        }
        changes.push_back(static_cast<double>(changed));
        resolved.push_back(share_of(clear, capture.lit.size()) > 0.6);
    }
    // The finest bit changes every other half period; the one before half as often, and so on.
    const double lines = changes.empty() ? 0 : *std::max_element(changes.begin(), changes.end());
    for (std::size_t k = 0; k + 1 < changes.size(); ++k) {
        const double expected = lines / std::pow(2.0, static_cast<double>(changes.size() - 1 - k));
        if (expected < lines / 32 || expected < 60 || !resolved[k + 1]) continue;  // too few stripes over the surface to count on
        if (changes[k] > 1.25 * changes[k + 1])
            check.problems.push_back({direction.gray[k],
                                      fmt::format("{} has finer stripes than {}", capture.name(direction.gray[k]),
                                                  capture.name(direction.gray[k + 1])),
                                      share_of(static_cast<std::size_t>(changes[k]), looked)});
    }
}

}  // namespace

SequenceCheck check_sequence(std::span<const GrayImage> frames, const StripeSettings& stripes) {
    Capture capture = sorted(frames, stripes);
    SequenceCheck check;
    check_ends(capture, check);
    check.checked = check.checked && (capture.lit.size() >= kEnough || !check.problems.empty());
    if (!check.checked || !check.problems.empty()) return check;
    for (const Direction& direction : capture.directions) {
        const std::vector<Fringe> fringes = fringes_of(capture, direction.phase);
        check_pairs(capture, direction, check);
        check_fringes(capture, direction, fringes, check);
        check_parity(capture, direction, fringes, check);
        check_order(capture, direction, check);
    }
    return check;
}

}  // namespace planlight
