#pragma once

#include <optional>
#include <vector>

namespace planlight {

/// Brightness of two halves of the tiles, frame by frame, grey: their noise has nothing in common, the light has.
struct PairedTrace {
    std::vector<double> at_s, a, b;

    double lasted_s() const { return at_s.back() - at_s.front(); }
};

/// What two halves have in common over time, grey squared.
struct Covariance {
    double common = 0, sigma = 0;
    double correlation = 0;  ///< 0 noise, 1 light
};

/// A periodic light as the frames met it, over whole cycles.
struct WaveFit {
    double mean = 0, mean_sigma = 0;          ///< grey, in the middle of the drift
    double variance = 0, variance_sigma = 0;  ///< grey squared; free of noise on average
    Covariance left_over;                     ///< of what the waves do not explain
};

/// Mean, straight line, one sine each of `waves_hz` (`hz` and multiples of it) and of `beside_hz` by least squares.
/// What the waves do not explain (a wheel's light has corners) is summed over the phases that were met, each with its
/// part of the turn (trapezoidal rule). The sigmas are a jackknife's over 20 stretches of time (Efron & Stein, Ann.
/// Statist. 9, 1981), so that frames that met the same phase do not count twice. `beside_hz` are not in the variance.
///
/// Frequencies are those that the frames see: a light of 240 Hz before 50 frames a second is one of 10 Hz.
WaveFit fit_wave(const PairedTrace& trace, const std::vector<double>& waves_hz, const std::vector<double>& beside_hz);

/// The halves' covariance after mean, straight line and one sine each of `beside_hz`.
Covariance covariance_beside(const PairedTrace& trace, const std::vector<double>& beside_hz, double* mean = nullptr);

/// The frequency whose sine explains most of all traces together, up to `highest_hz`, after mean, straight line and
/// `beside_hz`; empty when none explains half of what is left.
std::optional<double> strongest_hz(const std::vector<PairedTrace>& traces, double highest_hz,
                                   const std::vector<double>& beside_hz);

/// The largest part of a turn of `hz` in which no frame lies: 0 all of it was seen, 1 a single phase.
double widest_gap(const std::vector<double>& at_s, double hz);

}  // namespace planlight
