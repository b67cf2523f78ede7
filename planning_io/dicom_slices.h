#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

namespace planlight {

/// What one slice of a series says of itself.
struct DicomSlice {
    std::string file;
    Eigen::Vector3d position_in_ct;                ///< Image Position (Patient): centre of the first pixel, mm
    Eigen::Vector3d row_direction, column_direction; ///< Image Orientation (Patient): along a row, along a column
    double column_spacing_mm = 0, row_spacing_mm = 0;///< between columns (along a row), between rows
    int columns = 0, rows = 0;
    std::string frame_of_reference_uid, patient;
};

struct DicomRefusal {
    std::string problem, remedy;
};

/// Why the slices, in any order, are not one safe volume; empty when they are: evenly spaced to 0.01 mm along their normal
/// and on one straight line, one orientation (1e-4), one size and spacing, one patient and frame of reference, at least 16.
std::optional<DicomRefusal> fault_of(std::vector<DicomSlice> slices);

/// The affine of slices in this order (they have no fault): i along a row, j along a column, k from slice to slice.
Eigen::Affine3d ct_from_voxel_of(const std::vector<DicomSlice>& slices);

}  // namespace planlight
