#include "registration/scan/decode/second_harmonic.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>

#include "planning_io/types/statistics.h"

namespace planlight {
namespace {

using std::numbers::pi;

constexpr std::size_t kCells = 3072;      // of the table, over a turn of thrice the phase
constexpr double kLeastSlope = 0.1;       // of the sampled phase by the true one: below it noise says the place
constexpr double kLeastCertainty = 0.25;  // a pixel at a crest is not dropped for being dark
constexpr double kFarthest = 0.5;         // r is looked for up to here: a gamma of 5
constexpr std::size_t kBins = 24, kLeastInBin = 30;
constexpr double kLeastLight_grey = 24;
constexpr int kSaturated = 250;

std::complex<double> sampled(double phase, double r) {
    return std::polar(1.0, phase) + r * std::polar(1.0, -2 * phase);
}

/// Of the sampled phase by the true one.
double slope(double phase, double r) {
    const std::complex<double> by_phase =
        std::complex<double>(0, 1) * (std::polar(1.0, phase) - 2 * r * std::polar(1.0, -2 * phase));
    return (by_phase / sampled(phase, r)).imag();
}

/// Calls `visit(phase, sampled phase, |sampled|)` along a third of a period, from which the rest follows.
template <class Visit>
void along_a_third(double r, int steps, const Visit& visit) {
    for (int i = 0; i <= steps; ++i) {
        const double phase = (2.0 * i / steps - 1) * pi / 3;
        const std::complex<double> z = sampled(phase, r);
        visit(phase, phase + std::arg(z * std::polar(1.0, -phase)), std::abs(z));
    }
}

std::size_t bin_of(double sampled_phase) {
    const double folded = std::abs(std::remainder(3 * sampled_phase, 2 * pi)) / pi;
    return std::min(kBins - 1, static_cast<std::size_t>(folded * kBins));
}

/// Median logarithm of (amplitude by contrast) by thrice the phase; NaN where a bin has too few pixels.
struct Amplitudes {
    std::array<double, kBins> logarithm;
    std::size_t known = 0;
};

Amplitudes amplitudes_of(const std::array<const std::uint8_t*, 3>& shifts, const std::uint8_t* white,
                         const std::uint8_t* black, std::size_t pixels) {
    std::array<std::vector<float>, kBins> values;
    const std::size_t step = 1 + pixels / 400000;
    for (std::size_t i = 0; i < pixels; i += step) {
        const int contrast = white[i] - black[i], a = shifts[0][i], b = shifts[1][i], c = shifts[2][i];
        if (contrast < kLeastLight_grey || std::max({int{white[i]}, a, b, c}) >= kSaturated) continue;
        const double sine = (b - c) / std::sqrt(3.0), cosine = (2 * a - b - c) / 3.0;
        const double amplitude = std::hypot(sine, cosine);
        if (amplitude < std::max(8.0, 0.08 * contrast)) continue;
        values[bin_of(std::atan2(sine, cosine))].push_back(static_cast<float>(std::log(amplitude / contrast)));
    }
    Amplitudes found;
    found.logarithm.fill(std::nan(""));
    for (std::size_t bin = 0; bin < kBins; ++bin) {
        if (values[bin].size() < kLeastInBin) continue;
        found.logarithm[bin] = median(values[bin]);
        ++found.known;
    }
    return found;
}

/// How far the amplitudes are from those of a fringe with this r, rms of the logarithms.
double misfit(const Amplitudes& seen, double r) {
    std::array<double, kBins> sum{}, count{};
    along_a_third(r, 720, [&](double, double phase, double amplitude) {
        sum[bin_of(phase)] += std::log(amplitude);
        ++count[bin_of(phase)];
    });
    double off = 0, squares = 0, n = 0;
    for (std::size_t bin = 0; bin < kBins; ++bin) {
        if (std::isnan(seen.logarithm[bin]) || count[bin] == 0) continue;
        const double difference = seen.logarithm[bin] - sum[bin] / count[bin];
        off += difference;
        squares += difference * difference;
        ++n;
    }
    return n > 0 ? std::sqrt(std::max(0.0, squares / n - off * off / (n * n))) : 1e9;
}

}  // namespace

std::optional<double> measure_second_harmonic(const std::array<const std::uint8_t*, 3>& shifts,
                                              const std::uint8_t* white, const std::uint8_t* black,
                                              std::size_t pixels) {
    constexpr double kStep = 0.01, kFine = 0.001;
    const Amplitudes seen = amplitudes_of(shifts, white, black, pixels);
    if (seen.known < 3 * kBins / 4) return std::nullopt;
    const auto best = [&](double from, double to, double step) {
        double found = from, least = 1e9;
        for (double r = from; r <= to; r += step)
            if (const double off = misfit(seen, r); off < least) least = off, found = r;
        return found;
    };
    const double about = best(-kFarthest, kFarthest, kStep);
    return best(about - kStep, about + kStep, kFine);
}

SecondHarmonic::SecondHarmonic(double share) : share_(share), turns_(kCells + 1), certainty_(kCells + 1) {
    std::vector<int> reached(kCells + 1);
    double last_phase = 0, last = -10;
    // A cell stands for (cell / kCells - 1/2) turns of thrice the sampled phase.
    const auto cell_at = [](double phase) { return (3 * phase / (2 * pi) + 0.5) * kCells; };
    along_a_third(share, 8 * static_cast<int>(kCells), [&](double phase, double sampled_phase, double) {
        const double here = cell_at(sampled_phase);
        if (last > -10 && here != last) {
            const double low = std::min(last, here), high = std::max(last, here);
            for (double cell = std::max(0.0, std::ceil(low)); cell < high && cell <= kCells; ++cell) {
                const double true_phase = last_phase + (phase - last_phase) * (cell - last) / (here - last);
                const auto k = static_cast<std::size_t>(cell);
                const double steep = slope(true_phase, share);
                ++reached[k];
                turns_[k] = static_cast<float>(true_phase / (2 * pi) - (cell / kCells - 0.5) / 3);
                certainty_[k] = steep < kLeastSlope ? 0.f : static_cast<float>(std::max(kLeastCertainty, steep));
            }
        }
        last = here, last_phase = phase;
    });
    for (std::size_t k = 0; k <= kCells; ++k) {
        if (reached[k] == 1) continue;
        turns_[k] = 0;
        certainty_[k] = k == 0 || k == kCells ? static_cast<float>(slope(pi / 3, share)) : 0.f;
    }
}

void SecondHarmonic::take_out(float* phase_px, float* amplitude, float period, std::size_t n) const {
    if (turns_.empty()) return;
    const float by_period = 3 / period;
    for (std::size_t i = 0; i < n; ++i) {
        const float thrice = phase_px[i] * by_period;
        if (!(std::abs(thrice) < 2)) continue;  // NaN as well
        const float at = (thrice - std::floor(thrice + 0.5f) + 0.5f) * kCells;
        const auto k = std::min(static_cast<std::size_t>(at), kCells - 1);
        const float part = at - static_cast<float>(k);
        phase_px[i] += period * (turns_[k] + part * (turns_[k + 1] - turns_[k]));
        amplitude[i] *= std::min(certainty_[k], certainty_[k + 1]);
    }
}

std::optional<double> largest_second_harmonic(std::span<const GrayImage> frames, const StripeSettings& stripes) {
    if (stripes.phase_steps != 3 && (stripes.order_periods_px.empty() || stripes.order_steps != 3)) return 0;
    std::map<std::pair<bool, int>, std::vector<const std::uint8_t*>> shifts;
    const auto sequence = stripe_sequence(stripes);
    if (frames.size() != sequence.size()) return 0;
    for (std::size_t i = 0; i < sequence.size(); ++i)
        if (sequence[i].kind == StripePattern::Kind::phase)
            shifts[{sequence[i].along_rows, sequence[i].frequency}].push_back(frames[i].pixels.data());
    double largest = 0;
    for (const auto& [which, of_one] : shifts) {
        if (of_one.size() != 3) continue;
        const auto share = measure_second_harmonic({of_one[0], of_one[1], of_one[2]}, frames[0].pixels.data(),
                                                   frames[1].pixels.data(), frames[0].pixels.size());
        if (!share) return std::nullopt;
        if (std::abs(*share) > std::abs(largest)) largest = *share;
    }
    return largest;
}

}  // namespace planlight
