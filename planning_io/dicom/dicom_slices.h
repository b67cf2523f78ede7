#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/dicom/slice_gaps.h"

namespace planlight {

/// What one slice (a file, or one frame of a multi-frame file) says of itself; what it does not say is NaN or empty.
struct DicomSlice {
    static constexpr double kUnsaid = std::numeric_limits<double>::quiet_NaN();

    std::string file;  ///< name, and frame when there are several
    Eigen::Vector3d position_in_ct =
        Eigen::Vector3d::Constant(kUnsaid);  ///< Image Position (Patient): centre of the first pixel, mm
    Eigen::Vector3d row_direction = Eigen::Vector3d::Constant(kUnsaid);  ///< Image Orientation (Patient): along a row
    Eigen::Vector3d column_direction = Eigen::Vector3d::Constant(kUnsaid);  ///< along a column
    double column_spacing_mm = kUnsaid, row_spacing_mm = kUnsaid;  ///< between columns (along a row), between rows
    int columns = 0, rows = 0;
    std::string frame_of_reference_uid, patient, patient_position;
    int samples = 1;                  ///< 3: a colour picture
    std::string stored_as;            ///< bits and sign of its pixels
    std::string transfer_syntax;      ///< UID; empty: implicit little endian
    double slope = 1, intercept = 0;  ///< of the rescaling
    bool has_rescale = false;
    std::string defaced;    ///< how it says that the face was taken away
    std::string projected;  ///< how it says that it was made of several slices, as a MIP is
    double thickness_mm = kUnsaid;
    double gantry_tilt_deg = kUnsaid;  ///< as the header says; the slices' places may say otherwise
    /// Of an MR: `Volume::fat_shift_in_ct`; zero when it does not say, or fat was suppressed.
    Eigen::Vector3d fat_shift_in_ct = Eigen::Vector3d::Zero();
};

/// Why a series makes no volume, and what to do.
struct DicomRefusal {
    std::string problem, remedy;
};

/// Why the slices, in any order, are not one safe volume; empty when they are: evenly spaced along their
/// normal (each within 0.05 mm, or 2 % of the step, of its place; with `resampled` any steps of 0.5 to 20 mm) and on
/// one straight line, one orientation (1e-4), one size and spacing, one patient and frame of reference, at least 16.
std::optional<DicomRefusal> fault_of(std::vector<DicomSlice> slices, SliceGaps gaps = SliceGaps::refused);

/// How far the slices lie along the straight line of their stack, mm from the first, in this order.
std::vector<double> places_along_stack(const std::vector<DicomSlice>& slices);

/// The furthest that a slice lies from its place on the even grid of `ct_from_voxel_of`, mm.
double unevenness_of(const std::vector<DicomSlice>& slices);

/// Whether each slice lies within 0.05 mm, or 2 % of the step, of its place on that grid.
bool is_even(const std::vector<DicomSlice>& slices);

/// How far the directions of rows and columns are from length 1, and the cosine between them from 0: the greatest.
double axes_off(const DicomSlice& slice);

/// Directions that are off by no more are taken as they are written.
inline constexpr double kAsWritten = 1e-4;

/// The affine of slices in this order (they have no fault): i along a row, j along a column, k from slice to slice.
/// Directions that are written in few digits are made of length 1 and perpendicular.
Eigen::Affine3d ct_from_voxel_of(const std::vector<DicomSlice>& slices);

/// The angle between the slices' normal and the way from slice to slice, radians: a tilted gantry's.
double tilt_of(const Eigen::Affine3d& ct_from_voxel);

/// Whether the pixels can be unpacked, and whether they were packed with loss.
enum class TransferSyntax { unknown, lossless, lossy };

/// By the UID of file group 2; see TransferSyntax for one that is not known.
TransferSyntax transfer_syntax_of(const std::string& uid);

}  // namespace planlight
