#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace planlight {

/// A CT or MR volume. Voxel (i,j,k) has its centre at `ct_from_voxel * (i,j,k)`; i runs fastest in `values`.
struct Volume {
    std::array<int, 3> size{0, 0, 0};  ///< voxels along i, j, k
    Eigen::Affine3d ct_from_voxel =
        Eigen::Affine3d::Identity();  ///< mm per voxel; right-handed; may be sheared (gantry tilt)
    std::vector<float> values;        ///< HU when `is_hu`, else as stored
    bool is_hu = false;
    std::string modality;                ///< "CT" or "MR"
    std::string frame_of_reference_uid;  ///< empty when the file has none
    std::string source;  ///< what it was read from, for reports: format, file name; never a patient's name
    std::string series_description,
        series_date;  ///< as the scanner has them, the date in ISO 8601; empty when not said
    /// Of an MR: how far fat is drawn aside of all else along the readout, mm (chemical shift); its sign is not told.
    /// Zero when not said.
    Eigen::Vector3d fat_shift_in_ct = Eigen::Vector3d::Zero();
    /// The farthest that two slices lay apart before they were laid onto this grid, mm; 0: they lie as scanned.
    double widest_gap_mm = 0;
    std::vector<std::string>
        notes;  ///< what was noticed and did not stop the reading, in words; never a name, id or path

    std::size_t index(int i, int j, int k) const {
        return (static_cast<std::size_t>(k) * static_cast<std::size_t>(size[1]) + static_cast<std::size_t>(j)) *
                   static_cast<std::size_t>(size[0]) +
               static_cast<std::size_t>(i);
    }
    float at(int i, int j, int k) const { return values[index(i, j, k)]; }
    /// Distance of neighbouring voxel centres along i, j, k, mm.
    Eigen::Vector3d spacing_mm() const { return ct_from_voxel.linear().colwise().norm().transpose(); }
};

}  // namespace planlight
