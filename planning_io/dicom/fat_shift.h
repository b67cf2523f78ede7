#pragma once

#include <vtkDICOMMetaData.h>

#include "planning_io/dicom/dicom_slices.h"

namespace planlight {

/// `Volume::fat_shift_in_ct` as the header of an MR says it: fat answers 3.4 ppm lower than water; the pixel's
/// bandwidth says how many Hz a pixel as it was measured is (DICOM PS3.3 C.8.3.1, of Enhanced MR C.8.13.5). Zero when
/// it is not said, or fat was suppressed. `slice` knows its axes and spacings.
Eigen::Vector3d fat_shift_of(vtkDICOMMetaData* meta, int frame, const DicomSlice& slice);

}  // namespace planlight
