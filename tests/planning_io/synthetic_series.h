#pragma once

#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <functional>

#include "tests/planning_io/dicom_writer.h"

namespace planlight::test {

/// Whole HU of a phantom at a point of ct: a head without symmetry (skin with a slope of values, skull, brain, nose) in
/// air. Every place has its own value, so that a turned, shifted or mirrored volume is wrong nearly everywhere.
int phantom_hu(const Eigen::Vector3d& p_in_ct);

/// A grid over the phantom: i, j, k as the file has them.
struct Grid {
    std::array<int, 3> size{64, 64, 24};
    Eigen::Affine3d ct_from_voxel = Eigen::Translation3d(-94.5, -97, -46) * Eigen::Scaling(3.0, 3.0, 4.0);
};
std::vector<std::int16_t> phantom_values(const Grid& grid);

/// The grid with its axes along other directions (columns of `turn`) through the same middle, and slices shifted by
/// `shear_mm` each along j (a tilted gantry).
Grid turned_grid(const Eigen::Matrix3d& turn, double shear_mm = 0);

struct SeriesLook {
    std::string modality = "CT", patient = "Test^Phantom", patient_id = "PHANTOM-1", description = "Head thin",
                uid = "1.2.826.0.1.3680043.9.9999.7.1", number = "2";
    std::string position = "HFS";
    bool is_signed = false;  ///< unsigned, stored as HU + 1024; or signed, stored as HU
};

/// One object a slice, in order.
std::vector<DicomObject> synthetic_series(const Grid& grid, const SeriesLook& look = {});

/// One Enhanced CT or MR object with a frame a slice, the frames shuffled.
DicomObject enhanced_object(const Grid& grid, const SeriesLook& look = {});

/// Writes the objects as files with meaningless names in a meaningless order; gives the files in the order of the
/// objects.
std::vector<std::filesystem::path> write_series(const std::vector<DicomObject>& objects,
                                                const std::filesystem::path& folder,
                                                DicomEncoding encoding = DicomEncoding::explicit_little,
                                                const std::string& transfer_syntax = {});

}  // namespace planlight::test
