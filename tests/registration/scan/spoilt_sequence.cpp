#include "tests/registration/scan/spoilt_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace planlight::spoilt_sequence {
namespace {

using Kind = StripePattern::Kind;

RgbImage gray_picture(const stripe_room::Room& room, const StripePattern& p, int bits, double cell_px) {
    RgbImage picture(room.projector.width, room.projector.height);
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const int cell = static_cast<int>((p.along_rows ? y : x) / cell_px), code = cell ^ (cell >> 1);
            const bool set = ((code >> (bits - 1 - p.index)) & 1) != 0;
            const bool lit = p.kind == Kind::gray_bit           ? set
                             : p.kind == Kind::gray_bit_inverse ? !set
                                                                : p.kind == Kind::white;
            picture.at(x, y).fill(lit ? 255 : 0);
        }
    return picture;
}

}  // namespace

Sequence sequence_of(const stripe_room::Room& room, const StripeSettings& stripes) {
    return {stripes, stripe_sequence(stripes), photograph(room, room.left, stripes, 1)};
}

Sequence sequence_of(stripe_room::Surface surface, double ambient_grey, double white_grey) {
    stripe_room::Room room = stripe_room::paper_room(std::move(surface));
    room.light.noise_grey = 0;
    room.light.ambient_grey = ambient_grey;
    room.light.white_grey = white_grey;
    return sequence_of(room, stripe_room::stripes_of(room));
}

Sequence gray_code_of(const stripe_room::Room& room, double cell_px, bool inverse) {
    Sequence gray{
        stripe_room::stripes_of(room), {{Kind::white, false, 0, "white"}, {Kind::black, false, 0, "black"}}, {}};
    gray.stripes.phase_steps = 0;
    gray.stripes.phase_period_px = 2 * cell_px;
    gray.stripes.inverse = inverse;
    for (const bool rows : {false, true})
        for (StripePattern& pattern : gray_patterns(gray_bits(gray.stripes, rows), rows, inverse))
            gray.patterns.push_back(std::move(pattern));
    std::vector<stripe_room::Shown> shown;
    for (const StripePattern& p : gray.patterns)
        shown.push_back({gray_picture(room, p, gray_bits(gray.stripes, p.along_rows), cell_px), p.along_rows});
    gray.frames = photograph(room, room.left, shown, 1);
    return gray;
}

std::vector<GrayImage> with_noise(std::vector<GrayImage> frames, double sigma, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, sigma);
    constexpr std::size_t kNoises = 1 << 16;
    std::vector<int> noise(kNoises);
    for (int& n : noise) n = static_cast<int>(std::lround(normal(random)));
    for (GrayImage& f : frames) {
        std::size_t at = random();
        for (auto& p : f.pixels) p = static_cast<std::uint8_t>(std::clamp(p + noise[at++ % kNoises], 0, 255));
    }
    return frames;
}

double changed(const std::vector<GrayImage>& a, const std::vector<GrayImage>& b) {
    std::size_t lit = 0, differ = 0;
    for (std::size_t p = 0; p < a[0].pixels.size(); p += 7) {
        const int contrast = a[0].pixels[p] - a[1].pixels[p];
        if (contrast < 16) continue;
        ++lit;
        for (std::size_t i = 0; i < a.size(); ++i)
            if (3 * std::abs(a[i].pixels[p] - b[i].pixels[p]) > contrast) {
                ++differ;
                break;
            }
    }
    return static_cast<double>(differ) / static_cast<double>(lit);
}

void each_timing_fault(const Sequence& s, const std::function<void(const Fault&)>& look) {
    const std::size_t n = s.frames.size();
    const auto shown = [&](const char* what, std::size_t m, const auto& which) {
        Fault fault{fmt::format("{} at {}", what, s.patterns[m].name), s.frames};
        for (std::size_t i = 0; i < n; ++i) fault.frames[i] = s.frames[which(i)];
        look(fault);
    };
    for (std::size_t m = 0; m < n; ++m) {
        if (m > 0) shown("late_once", m, [=](std::size_t i) { return i == m ? i - 1 : i; });
        if (m + 1 < n) shown("early_once", m, [=](std::size_t i) { return i == m ? i + 1 : i; });
        if (m > 0) shown("late_from_here", m, [=](std::size_t i) { return i >= m ? i - 1 : i; });
        if (m > 1) shown("late_by_two", m, [=](std::size_t i) { return i >= m ? i - 2 : i; });
        if (m + 1 < n) shown("missing", m, [=](std::size_t i) { return i >= m ? std::min(i + 1, n - 1) : i; });
    }
}

void each_exchange(const Sequence& s, std::size_t first, const std::function<void(const Fault&)>& look) {
    for (std::size_t k = first + 1; k < s.frames.size(); ++k) {
        Fault fault{fmt::format("{} exchanged with {}", s.patterns[first].name, s.patterns[k].name), s.frames};
        std::swap(fault.frames[first], fault.frames[k]);
        look(fault);
    }
}

std::string said(const SequenceCheck& check) {
    std::string all = fmt::format("{} pixels;", check.pixels);
    for (const auto& p : check.problems) all += fmt::format(" [{} {} {:.3f}]", p.frame, p.what, p.share);
    return all;
}

}  // namespace planlight::spoilt_sequence
