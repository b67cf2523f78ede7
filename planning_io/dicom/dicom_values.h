#pragma once

#include <vector>

#include "planning_io/dicom/dicom_folder.h"
#include "planning_io/types/volume.h"

namespace planlight {

/// Where one slice's values came from, and what they mean.
struct SliceValues {
    double slope = 1, intercept = 0;
    bool has_padding = false;
    int padding = 0, padding_limit = 0;
};

/// Turns the stored values of `volume` (slice by slice, as `slices` say) into HU or MR values, and sets `is_hu`. What
/// was not measured becomes air: padding that is joined to the picture's edge, CT values below -1024 HU, and corners of
/// exactly 0 HU that a resampled tilted stack has where it ends. Noted in `volume.notes`.
void rescale(Volume& volume, const std::vector<SliceValues>& slices, const std::string& rescale_type, bool has_rescale);

}  // namespace planlight
