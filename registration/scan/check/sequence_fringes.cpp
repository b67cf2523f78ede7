#include "registration/scan/check/sequence_fringes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "planning_io/types/processor_clones.h"

namespace planlight::sequence {
namespace {

constexpr double kMostOffset = 0.05;  // of a period; one shift of sixteen is 0.06

/// Sums of the frames' values, plain, squared and weighted by the sine and cosine of once and twice their shift.
struct Sums {
    std::vector<float> plain, squares;
    std::array<std::vector<float>, 4> harmonics;
    explicit Sums(std::size_t n) : plain(n), squares(n) { harmonics.fill(std::vector<float>(n)); }
};

PLANLIGHT_CLONES void add_frame(const std::uint8_t* frame, const float* weights, float* __restrict plain,
                                float* __restrict squares, float* __restrict a, float* __restrict b,
                                float* __restrict c, float* __restrict d, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
        const float value = frame[i];
        plain[i] += value;
        squares[i] += value * value;  // whole numbers: exact
        a[i] += weights[0] * value;
        b[i] += weights[1] * value;
        c[i] += weights[2] * value;
        d[i] += weights[3] * value;
    }
}

}  // namespace

std::optional<std::size_t> twin_of(const Samples& s, std::size_t frame) {
    std::optional<std::size_t> twin;
    double best = 0.02;
    for (std::size_t other = 0; other < s.here.size(); ++other) {
        if (other == frame) continue;
        std::size_t differ = 0;
        for (std::size_t i = 0; i < s.lit; ++i)
            differ += std::abs(s.here[frame][i] - s.here[other][i]) > s.contrast[i] / 6 + 3 * s.noise_grey;
        if (const double share = share_of(differ, s.lit); share < best) {
            best = share;
            twin = other;
        }
    }
    return twin;
}

std::string explain(const Samples& s, std::size_t frame) {
    const auto twin = twin_of(s, frame);
    return twin ? fmt::format("; {} looks like {}", s.name(frame), s.name(*twin)) : "";
}

std::vector<Fringe> fringes_of(const Samples& s, const std::vector<std::size_t>& phases) {
    if (phases.size() < 3) return {};
    const auto n = static_cast<double>(phases.size());
    Sums sums(s.lit);
    for (std::size_t k = 0; k < phases.size(); ++k) {
        const double shift = 2 * std::numbers::pi * static_cast<double>(k) / n;
        const std::array<float, 4> weights{
            static_cast<float>(std::sin(shift) * 2 / n), static_cast<float>(std::cos(shift) * 2 / n),
            static_cast<float>(std::sin(2 * shift) * 2 / n), static_cast<float>(std::cos(2 * shift) * 2 / n)};
        add_frame(s.here[phases[k]].data(), weights.data(), sums.plain.data(), sums.squares.data(),
                  sums.harmonics[0].data(), sums.harmonics[1].data(), sums.harmonics[2].data(),
                  sums.harmonics[3].data(), s.lit);
    }
    std::vector<Fringe> fringes(s.lit);
    const auto frames = static_cast<float>(n);
    for (std::size_t i = 0; i < s.lit; ++i) {
        const float sine = sums.harmonics[0][i], cosine = sums.harmonics[1][i], power = sine * sine + cosine * cosine;
        const float by_power = power > 0 ? 1 / power : 0;
        // The second harmonic in phase with the fringe: cosine and sine of twice the phase.
        const float in_phase =
            (sums.harmonics[3][i] * (cosine * cosine - sine * sine) + sums.harmonics[2][i] * 2 * sine * cosine) *
            by_power;
        const float modelled = sums.plain[i] * sums.plain[i] / frames + frames / 2 * (power + in_phase * in_phase);
        const float left = std::max(0.0f, sums.squares[i] - modelled) / std::max(1.0f, frames - 4);
        fringes[i] = {std::sqrt(power), std::atan2(sine, cosine), std::sqrt(left)};
    }
    return fringes;
}

namespace {

/// Of a surface narrower than a fringe the light changes more from one picture to the next than to another.
bool all_shifts_are_there(const std::vector<Fringe>& fringes, std::size_t bins) {
    constexpr double kOfEvenly = 0.5;
    std::vector<double> found(bins, 0);
    for (const Fringe& fringe : fringes) {
        const double turn = fringe.phase / (2 * std::numbers::pi);
        ++found[std::min(bins - 1, static_cast<std::size_t>((turn - std::floor(turn)) * static_cast<double>(bins)))];
    }
    const double evenly = static_cast<double>(fringes.size()) / static_cast<double>(bins);
    return std::all_of(found.begin(), found.end(), [&](double count) { return count > kOfEvenly * evenly; });
}

/// Mean difference of each fringe picture to the one before it, from the second on, over the lit pixels, grey.
std::vector<double> steps_of(const Samples& s, const std::vector<std::size_t>& phases) {
    std::vector<double> steps;
    for (std::size_t k = 1; k < phases.size(); ++k) {
        double sum = 0;
        for (std::size_t i = 0; i < s.lit; ++i)
            sum += std::abs(int{s.here[phases[k]][i]} - int{s.here[phases[k - 1]][i]});
        steps.push_back(sum / std::max<double>(1, static_cast<double>(s.lit)));
    }
    return steps;
}

}  // namespace

void check_doubled(const Samples& s, const std::vector<std::size_t>& phases, const std::vector<Fringe>& fringes,
                   SequenceCheck& check) {
    constexpr double kOfUsual = 0.5;
    if (phases.size() < 5 || s.lit < kEnough || !all_shifts_are_there(fringes, phases.size())) return;
    const std::vector<double> steps = steps_of(s, phases);
    std::vector<double> sorted = steps;
    std::sort(sorted.begin(), sorted.end());
    const double usual = sorted[sorted.size() / 2];
    for (std::size_t k = 0; k < steps.size(); ++k)
        if (steps[k] < kOfUsual * usual)
            check.problems.push_back({phases[k + 1],
                                      fmt::format("{} looks like {}", s.name(phases[k + 1]), s.name(phases[k])), 1,
                                      SequenceProblem::Cause::timing});
}

void check_fringes(const Samples& s, const std::vector<std::size_t>& phases, const std::vector<Fringe>& fringes,
                   SequenceCheck& check) {
    if (phases.size() < 5) return;  // too few for anything to be left over
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < s.lit; ++i) {
        // Out of order frames may leave hardly any fringe: what a fringe of this light can have is its measure.
        const float strength = std::max(fringes[i].amplitude, 0.25f * s.contrast[i]);
        wrong += fringes[i].residual_grey > 0.12f * strength + static_cast<float>(2 * s.noise_grey);
    }
    constexpr double kMost = 0.12;
    if (s.lit < kEnough || share_of(wrong, s.lit) <= kMost) return;
    std::string twins;  // which frame it is, where that can be seen
    for (const std::size_t frame : phases) twins += explain(s, frame);
    check.problems.push_back(
        {phases[0],
         fmt::format("{} to {} are no fringes in order{}", s.name(phases.front()), s.name(phases.back()), twins),
         share_of(wrong, s.lit), twins.empty() ? SequenceProblem::Cause::fringes : SequenceProblem::Cause::timing});
}

void check_parity(const Samples& s, const Direction& direction, const std::vector<Fringe>& fringes,
                  SequenceCheck& check) {
    if (direction.phase.size() < 3 || direction.gray.empty()) return;
    const double half_px = s.stripes.phase_period_px / 2;
    std::size_t looked = 0, wrong = 0;
    for (std::size_t i = 0; i < s.lit; ++i) {
        const int contrast = s.contrast[i];
        if (fringes[i].amplitude < 0.1 * contrast + 2 * s.noise_grey) continue;
        const double pixel_in_period = fringes[i].phase * half_px / std::numbers::pi + 0.5;  // from the edge of pixel 0
        const double cell = std::floor(pixel_in_period / half_px), in_cell = pixel_in_period / half_px - cell;
        if (in_cell < 0.3 || in_cell > 0.7) continue;  // near its borders a bit may go either way
        bool odd = false, clear = true;
        for (std::size_t k = 0; k < direction.gray.size(); ++k) {
            const int difference = s.difference(direction, k, [&](std::size_t frame) { return int{s.here[frame][i]}; });
            clear = clear && 3 * std::abs(difference) > contrast;
            odd ^= difference > 0;
        }
        if (!clear) continue;
        ++looked;
        wrong += odd != (static_cast<int>(cell) % 2 != 0);
    }
    constexpr double kMost = 0.03;
    if (looked < kEnough || share_of(wrong, looked) <= kMost) return;
    check.problems.push_back(
        {direction.gray[0],
         fmt::format("the code of {} to {} contradicts {} to {}", s.name(direction.gray.front()),
                     s.name(direction.gray.back()), s.name(direction.phase.front()), s.name(direction.phase.back())),
         share_of(wrong, looked), SequenceProblem::Cause::fringes});
}

namespace {

/// Whether the Gray code of a pixel has an odd number of ones; empty where more than one bit is unclear: by the border
/// of two stripes the one that changes there may be.
std::optional<bool> is_odd(const Samples& s, const Direction& direction, std::size_t i) {
    bool odd = false;
    int unclear = 0;
    for (std::size_t k = 0; k < direction.gray.size(); ++k) {
        const int difference = s.difference(direction, k, [&](std::size_t frame) { return int{s.here[frame][i]}; });
        unclear += 3 * std::abs(difference) <= s.contrast[i];
        odd ^= difference > 0;
    }
    return unclear > 1 ? std::nullopt : std::optional(odd);
}

}  // namespace

std::optional<double> fringe_offset_px(const Samples& s, const Direction& direction,
                                       const std::vector<Fringe>& fringes) {
    if (direction.phase.size() < 3 || direction.gray.empty()) return std::nullopt;
    constexpr std::size_t kBins = 16, kLeastInBin = 20;
    const double half_px = s.stripes.phase_period_px / 2;
    std::array<std::size_t, kBins> all{}, behind{};
    for (std::size_t i = 0; i < s.lit; ++i) {
        if (fringes[i].amplitude < 0.1 * s.contrast[i] + 2 * s.noise_grey) continue;
        const auto odd = is_odd(s, direction, i);
        if (!odd) continue;
        const double cells = (fringes[i].phase * half_px / std::numbers::pi + 0.5) / half_px;
        const double border = std::floor(cells + 0.5), aside = cells - border;  // -0.5 to 0.5 of a cell
        const auto bin = std::min(kBins - 1, static_cast<std::size_t>((aside + 0.5) * kBins));
        ++all[bin];
        behind[bin] += *odd == (static_cast<int>(border) % 2 != 0);
    }
    double before = 0;
    for (std::size_t bin = 0; bin < kBins; ++bin) {
        if (all[bin] < kLeastInBin) return std::nullopt;
        before += 1 - share_of(behind[bin], all[bin]);
    }
    return (before / kBins - 0.5) * half_px;
}

void check_offset(const Samples& s, const Direction& direction, const std::vector<Fringe>& fringes,
                  SequenceCheck& check) {
    const auto offset_px = fringe_offset_px(s, direction, fringes);
    if (!offset_px || std::abs(*offset_px) < kMostOffset * s.stripes.phase_period_px) return;
    check.problems.push_back(
        {direction.phase[0],
         fmt::format("the fringes of {} to {} lie {:.1f} projector pixels beside the code of {} "
                     "to {}: another of them is the first, or something moved in between",
                     s.name(direction.phase.front()), s.name(direction.phase.back()), std::abs(*offset_px),
                     s.name(direction.gray.front()), s.name(direction.gray.back())),
         1, SequenceProblem::Cause::fringes});
}

namespace {

/// By how many turns the phases of a pixel disagree at least, rms, wherever in the picture it may lie.
double least_disagreement(const StripeSettings& stripes, int size, const std::vector<std::vector<Fringe>>& fringes,
                          std::size_t i) {
    const double turns = fringes[0][i].phase / (2 * std::numbers::pi);
    const int orders = static_cast<int>(std::ceil(size / stripes.phase_period_px)) + 1;
    double least = 1;
    for (int order = 0; order < orders; ++order) {
        double squares = 0;
        for (std::size_t k = 1; k < fringes.size(); ++k) {
            const double off = (order + turns) * stripes.phase_period_px / stripes.order_periods_px[k - 1] -
                               fringes[k][i].phase / (2 * std::numbers::pi);
            squares += (off - std::floor(off + 0.5)) * (off - std::floor(off + 0.5));
        }
        least = std::min(least, squares / static_cast<double>(fringes.size() - 1));
    }
    return std::sqrt(least);
}

}  // namespace

void check_frequencies(const Samples& s, const Direction& direction, const std::vector<std::vector<Fringe>>& fringes,
                       SequenceCheck& check) {
    if (fringes.size() < 2 || fringes[0].empty()) return;
    // A gamma moves phases of three shifts by up to a twentieth of a turn, each its own way.
    const bool three_shifts = std::min(s.stripes.phase_steps, s.stripes.order_steps) == 3;
    const double most_turns = three_shifts ? 0.09 : 0.05;
    constexpr double kLeast_grey = 12, kMost = 0.1;
    const bool rows = s.patterns[direction.phase.front()].along_rows;
    const int size = rows ? s.stripes.height : s.stripes.width;
    std::size_t looked = 0, wrong = 0;
    for (std::size_t i = 0; i < s.lit; ++i) {
        double amplitude = fringes[0][i].amplitude;
        for (const auto& of_one : fringes) amplitude = std::min<double>(amplitude, of_one[i].amplitude);
        if (amplitude < std::max(kLeast_grey, 0.15 * s.contrast[i])) continue;
        ++looked;
        wrong += least_disagreement(s.stripes, size, fringes, i) > most_turns;
    }
    if (looked < kEnough || share_of(wrong, looked) <= kMost) return;
    check.problems.push_back({direction.phase[0],
                              fmt::format("the fringes from {} to {} do not belong to each other",
                                          s.name(direction.phase.front()), s.name(direction.further.back().back())),
                              share_of(wrong, looked), SequenceProblem::Cause::fringes});
}

}  // namespace planlight::sequence
