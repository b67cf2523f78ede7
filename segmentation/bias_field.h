#pragma once

#include <array>

#include "planning_io/types/volume.h"

namespace planlight {

/// How much brighter than the mean the coils of an MR scanner show a place: a smooth factor over the volume, the
/// exponential of a polynomial of second order in the voxels' indices.
struct BiasField {
    std::array<double, 10>
        log_coefficients{};  ///< of 1, x, y, z, xx, yy, zz, xy, xz, yz; each axis from -1 to 1 over the volume
    double log_low = 0, log_high = 0;  ///< its range over the tissue; beyond, the nearer end holds

    /// Of the brightest place of the tissue to the darkest; 1 when there is no bias.
    double ratio() const;
};

/// The factor that makes the logarithms of the tissue's values most alike: tissue is what lies over the threshold
/// (`skin_threshold`) once the factor is taken out; both are found by turns, values far from the rest left out (after
/// the idea of Styner et al. 2000, parametric bias field correction). Of a volume without enough tissue: none (ratio
/// 1).
BiasField fit_bias(const Volume& volume);

/// The volume with its values divided by the factor.
Volume without_bias(Volume volume, const BiasField& bias);

}  // namespace planlight
