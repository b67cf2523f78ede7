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

/// A periodic light as the frames met it: mean, slow drift, harmonics of one frequency.
struct WaveFit {
    double mean = 0;            ///< grey, over whole cycles, in the middle of the drift
    double variance = 0;        ///< of the harmonics over whole cycles, grey squared; free of noise on average
    double variance_sigma = 0;  ///< one standard deviation
    Covariance left_over;       ///< of what the fit does not explain
};

/// Least squares with mean, straight line, `harmonics` multiples of `hz` (0: none), and one sine each of `beside_hz`,
/// which is not counted in `variance`.
///
/// Frequencies are those that the frames see: a light of 240 Hz before 50 frames a second is one of 10 Hz.
WaveFit fit_wave(const PairedTrace& trace, double hz, int harmonics, const std::vector<double>& beside_hz);

/// The frequency whose sine explains most of all traces together, up to `highest_hz`, after mean, straight line and
/// `beside_hz`; empty when none explains half of what is left.
std::optional<double> strongest_hz(const std::vector<PairedTrace>& traces, double highest_hz,
                                   const std::vector<double>& beside_hz);

/// The largest part of a turn of `hz` in which no frame lies: 0 all of it was seen, 1 a single phase.
double widest_gap(const std::vector<double>& at_s, double hz);

}  // namespace planlight
