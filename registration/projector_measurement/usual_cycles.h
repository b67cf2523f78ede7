#pragma once

#include <vector>

namespace planlight {

/// A frequency of light that is usual, and how well it is known.
struct UsualCycle {
    double hz = 0, tolerance_hz = 0;
};

/// Twice the mains of the world: 100 and 120 Hz, by as much as a grid strays.
std::vector<UsualCycle> usual_cycles_of_lamps();

/// 1 to 6 cycles a picture: colour wheels, and lamps or panels that are dimmed by pulses.
std::vector<UsualCycle> usual_cycles_of_projectors(double refresh_hz, double tolerance_hz);

/// Those that look like `seen_hz` at that frame rate; `seen_sigma_hz`: how well it is seen.
std::vector<double> cycles_that_look_like(double seen_hz, double seen_sigma_hz, const std::vector<UsualCycle>& usual,
                                          double frames_hz);

/// Those that may turn by less than half in `lasted_s` against the frames: they look like steady light.
std::vector<double> cycles_that_stand_still(const std::vector<UsualCycle>& usual, double frames_hz, double lasted_s);

/// The largest standard deviation that the light of exposures can have, share of its mean, whatever the shape of the
/// cycle: an exposure of n + f cycles (n whole) gets n cycles' light at least and n + 1 at most, and values between two
/// limits l and h with mean 1 have a variance of at most (h - 1) (1 - l) (Bhatia & Davis, Amer. Math. Monthly 107,
/// 2000).
/// `lowest_hz`: of the slowest cycle that there may be.
double most_variation(double exposure_s, double lowest_hz);

/// The shortest exposure, not under `at_least_s`, that holds whole cycles of all; 0: none up to 0.2 s.
double whole_cycles_s(double at_least_s, const std::vector<double>& cycles_hz);

}  // namespace planlight
