#include "registration/scan/pattern/stripe_patterns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace planlight {
namespace {

constexpr int kMaxGrayBits = 15;  // the decoder keeps a code in 16 bits

int cells(const StripeSettings& s, bool along_rows) {
    return (along_rows ? s.begins_at_row : s.begins_at_column) +
           static_cast<int>(std::ceil((along_rows ? s.height : s.width) / (s.phase_period_px / 2)));
}

std::uint8_t gray_value(const StripeSettings& s, int pixel, int bit, int bits, bool inverse) {
    const int cell = static_cast<int>(std::floor((pixel + 0.5) / (s.phase_period_px / 2)));
    const int code = cell ^ (cell >> 1);
    const bool lit = ((code >> (bits - 1 - bit)) & 1) != 0;
    return static_cast<std::uint8_t>(lit != inverse ? s.brightness : 0);
}

/// An even function of the pixel about every crest, so that no gamma shifts it; from dark to full brightness.
std::uint8_t phase_value(const StripeSettings& s, int pixel, int frequency, int step) {
    const double turns = pixel / period_of(s, frequency) - static_cast<double>(step) / steps_of(s, frequency);
    return static_cast<std::uint8_t>(std::lround(s.brightness * (0.5 + 0.5 * std::cos(2 * std::numbers::pi * turns))));
}

std::uint8_t value_at(const StripeSettings& s, const StripePattern& pattern, int pixel, int bits) {
    switch (pattern.kind) {
        case StripePattern::Kind::white:
            return static_cast<std::uint8_t>(s.brightness);
        case StripePattern::Kind::black:
            return 0;
        case StripePattern::Kind::gray_bit:
            return gray_value(s, pixel, pattern.index, bits, false);
        case StripePattern::Kind::gray_bit_inverse:
            return gray_value(s, pixel, pattern.index, bits, true);
        case StripePattern::Kind::phase:
            return phase_value(s, pixel, pattern.frequency, pattern.index);
    }
    throw std::invalid_argument("draw_stripes: a kind of picture that is not in the sequence");
}

void add_direction(const StripeSettings& s, bool along_rows, std::vector<StripePattern>& sequence) {
    const std::string direction = along_rows ? "row" : "column";
    for (StripePattern& pattern : gray_patterns(gray_bits(s, along_rows), along_rows, s.inverse))
        sequence.push_back(std::move(pattern));
    for (int step = 0; step < s.phase_steps; ++step)
        sequence.push_back({StripePattern::Kind::phase, along_rows, step, fmt::format("{}-phase-{}", direction, step)});
    for (int frequency = 1; frequency <= static_cast<int>(s.order_periods_px.size()); ++frequency)
        for (int step = 0; step < s.order_steps; ++step)
            sequence.push_back({StripePattern::Kind::phase, along_rows, step,
                                fmt::format("{}-phase{}-{}", direction, frequency + 1, step), frequency});
}

double off_whole(double turns) {
    return std::abs(turns - std::round(turns));
}

/// How far apart the phases of any two of the fringes are at least, in turns over all further frequencies, where these
/// make `turns` whole turns over all fringes.
double least_distance(int fringes, const std::vector<int>& turns) {
    double least = 1;
    for (int apart = 1; 2 * apart <= fringes; ++apart) {
        double squares = 0;
        for (const int t : turns) squares += std::pow(off_whole(static_cast<double>(apart) * t / fringes), 2);
        least = std::min(least, squares);
    }
    return std::sqrt(least);
}

/// The two or three frequencies, each lower than the first and over half of it, that keep all fringes farthest apart:
/// their phases are a lattice (rank 1, Korobov), tried out.
std::vector<int> best_turns(int fringes, int frequencies) {
    std::vector<int> best;
    double farthest = -1;
    const int lowest = fringes / 2 + 1, step = 1 + fringes / 150;  // not all of them for a very wide projector
    for (int a = lowest; a < fringes; a += step)
        for (int b = lowest; b < a; b += step)
            for (int c = frequencies == 3 ? lowest : b - 1; c < b; c += step) {
                const std::vector<int> turns = frequencies == 3 ? std::vector{a, b, c} : std::vector{a, b};
                if (const double distance = least_distance(fringes, turns); distance > farthest)
                    farthest = distance, best = turns;
            }
    return best;
}

/// Two fringes of the first frequency at which all the others have nearly the same phase are not told apart: how many
/// fringes they are apart; 0 where there are none.
int fringes_confused(const StripeSettings& s) {
    constexpr double kLeastTurns = 0.1;
    const int fringes = static_cast<int>(std::ceil(std::max(s.width, s.rows ? s.height : 0) / s.phase_period_px));
    for (int apart = 1; apart < fringes; ++apart) {
        double squares = 0;
        for (const double period : s.order_periods_px)
            squares += std::pow(off_whole(apart * s.phase_period_px / period), 2);
        if (squares < kLeastTurns * kLeastTurns) return apart;
    }
    return 0;
}

}  // namespace

void check_stripes(const StripeSettings& s) {
    const auto refuse = [](const std::string& why) { throw std::invalid_argument("stripes: " + why); };
    if (s.width < 1 || s.height < 1) refuse(fmt::format("the projector has {} x {} pixels", s.width, s.height));
    if (s.phase_steps < 3) refuse(fmt::format("{} phase steps; at least 3 are needed", s.phase_steps));
    if (!(s.phase_period_px >= 4))
        refuse(fmt::format("a phase period of {} pixels; at least 4 are needed", s.phase_period_px));
    if (s.brightness < 1 || s.brightness > 255) refuse(fmt::format("a brightness of {}; 1 to 255", s.brightness));
    if (!s.order_periods_px.empty()) {
        if (s.order_steps < 3 || s.order_periods_px.size() > 8)
            refuse(fmt::format("{} further fringes of {} steps; up to 8 of at least 3", s.order_periods_px.size(),
                               s.order_steps));
        for (const double period : s.order_periods_px)
            if (!(period >= 4)) refuse(fmt::format("a phase period of {} pixels; at least 4 are needed", period));
        if (const int apart = fringes_confused(s); apart > 0)
            refuse(fmt::format("fringes {} periods apart have the same phase in all frequencies", apart));
    }
    if (gray_bits(s, false) > kMaxGrayBits || gray_bits(s, true) > kMaxGrayBits)
        refuse(fmt::format("more than {} Gray bits; a longer phase period needs fewer", kMaxGrayBits));
}

StripeSettings fast_stripes(int width, int height) {
    StripeSettings stripes;
    stripes.width = width;
    stripes.height = height;
    stripes.rows = stripes.inverse = false;
    stripes.phase_steps = 5;
    return stripes;
}

StripeSettings multi_frequency_stripes(int width, int height, bool rows) {
    constexpr double kFar_turns = 0.12;
    StripeSettings stripes;
    stripes.width = width;
    stripes.height = height;
    stripes.rows = rows;
    stripes.inverse = false;
    const int fringes = 2 + static_cast<int>(std::ceil(std::max(width, rows ? height : 0) / stripes.phase_period_px));
    std::vector<int> turns = best_turns(fringes, 2);
    if (least_distance(fringes, turns) < kFar_turns) turns = best_turns(fringes, 3);
    for (const int t : turns) stripes.order_periods_px.push_back(stripes.phase_period_px * fringes / t);
    return stripes;
}

double period_of(const StripeSettings& s, int frequency) {
    return frequency == 0 ? s.phase_period_px : s.order_periods_px.at(static_cast<std::size_t>(frequency - 1));
}

int steps_of(const StripeSettings& s, int frequency) {
    return frequency == 0 ? s.phase_steps : s.order_steps;
}

int gray_bits(const StripeSettings& settings, bool along_rows) {
    if (!settings.order_periods_px.empty()) return 0;
    int bits = 1;
    while (bits < 30 && (1 << bits) < cells(settings, along_rows)) ++bits;
    return bits;
}

std::vector<StripePattern> gray_patterns(int bits, bool along_rows, bool inverse) {
    std::vector<StripePattern> patterns;
    for (int bit = 0; bit < bits; ++bit) {
        const std::string name = fmt::format("{}-gray-{}", along_rows ? "row" : "column", bit);
        patterns.push_back({StripePattern::Kind::gray_bit, along_rows, bit, name});
        if (inverse) patterns.push_back({StripePattern::Kind::gray_bit_inverse, along_rows, bit, name + "-inverse"});
    }
    return patterns;
}

std::vector<StripePattern> stripe_sequence(const StripeSettings& settings) {
    check_stripes(settings);
    std::vector<StripePattern> sequence{{StripePattern::Kind::white, false, 0, "white"},
                                        {StripePattern::Kind::black, false, 0, "black"}};
    add_direction(settings, false, sequence);
    if (settings.rows) add_direction(settings, true, sequence);
    return sequence;
}

RgbImage draw_stripes(const StripeSettings& settings, const StripePattern& pattern) {
    check_stripes(settings);
    const int bits = gray_bits(settings, pattern.along_rows);
    const bool is_gray =
        pattern.kind == StripePattern::Kind::gray_bit || pattern.kind == StripePattern::Kind::gray_bit_inverse;
    const bool is_phase = pattern.kind == StripePattern::Kind::phase;
    const bool is_frequency =
        pattern.frequency >= 0 && pattern.frequency <= static_cast<int>(settings.order_periods_px.size());
    if (pattern.index < 0 || (is_gray && pattern.index >= bits) ||
        (is_phase && (!is_frequency || pattern.index >= steps_of(settings, pattern.frequency))))
        throw std::invalid_argument(fmt::format("draw_stripes: no picture {} in this sequence", pattern.name));
    RgbImage picture(settings.width, settings.height);
    if (pattern.along_rows) {
        for (int y = 0; y < settings.height; ++y) {
            const std::uint8_t v = value_at(settings, pattern, y, bits);
            for (int x = 0; x < settings.width; ++x) picture.at(x, y) = {v, v, v};
        }
        return picture;
    }
    std::vector<Rgb> line(static_cast<std::size_t>(settings.width));
    for (int x = 0; x < settings.width; ++x)
        line[static_cast<std::size_t>(x)].fill(value_at(settings, pattern, x, bits));
    for (int y = 0; y < settings.height; ++y)
        std::copy(line.begin(), line.end(), picture.pixels.begin() + static_cast<std::ptrdiff_t>(picture.index(0, y)));
    return picture;
}

}  // namespace planlight
