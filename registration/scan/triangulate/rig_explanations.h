#pragma once

#include <vector>

#include "registration/scan/triangulate/find_rig_state.h"
#include "registration/scan/triangulate/rig_residuals.h"

// The ways in which a rig may have changed, fitted to one scan. Private to registration/scan/triangulate.
namespace planlight {

/// One way in which the rig may have changed.
struct Explanation {
    std::vector<RigDevice> moved, lens;
    double penalty = 0;

    RigNumbers numbers = RigNumbers::Zero();  // found
    RigMatrix covariance = RigMatrix::Zero();
    double chi_square = 0, usual = 0;
};

/// The rig as it was calibrated, and, cheapest first, every other explanation; these only where one can be better by
/// `RigStateSettings::moved_chi_square`.
struct RigFits {
    Explanation as_calibrated;
    std::vector<Explanation> others;
    double noise =
        1;  ///< chi-squares are to be compared by this: more where the light is read with more noise than expected
};

/// `places` are those of one scan, evenly over the surface.
RigFits fit_explanations(const std::vector<SeenPlace>& places, const RigCalibration& rig,
                         const RigStateSettings& settings);

}  // namespace planlight
