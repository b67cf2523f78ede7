#pragma once

#include <Eigen/Core>
#include <optional>

#include "planning_io/types/volume.h"

namespace planlight {

/// A second image of the head within the first, as when the patient moved before the series was done.
struct SeriesEcho {
    Eigen::Vector3d shift_in_ct = Eigen::Vector3d::Zero();  ///< from one image to the other, mm; its sign is not known
    double strength = 0;  ///< peak of the cepstrum: about the weaker image's share of the stronger
    double ratio = 0;     ///< of the peak to the largest that lies as far out in any other direction

    bool is_movement() const;  ///< no head that lay still has so strong and so single an echo
};

/// The strongest echo in the volume: the peak of its power cepstrum (Bogert, Healy & Tukey 1963) between 5 and 24 mm,
/// whatever the contrast. Two images that lie apart by a shift make ripples all over the spectrum, which anatomy does
/// not. Empty where the volume shows too little above its noise, or has slices of more than 3.4 mm. A movement of less
/// than 5 mm does not show.
std::optional<SeriesEcho> strongest_echo(const Volume& volume);

}  // namespace planlight
