#pragma once

#include <string>

#include "planning_io/types/volume.h"

namespace planlight {

/// Where air ends and the body begins, in the volume's own unit.
///
/// HU: the middle between the air peak and the soft-tissue peak, kept within [-500, -150] (cone-beam greys,
/// whose soft tissue lies elsewhere: [-650, -150]). Otherwise: the middle
/// between the peaks on both sides of Otsu's threshold (Otsu 1979). Of a phantom in HU any matter counts for soft
/// tissue. Throws InputError when there are no two peaks.
double skin_threshold(const Volume& volume, bool phantom = false);

/// As a person reads it and `planlight prepare --threshold` takes it: three digits, whole from 100 on ("0.214",
/// "-87.4", "12346"), never with an exponent.
std::string threshold_text(double threshold);

}  // namespace planlight
