#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "planning_io/types/triangle_mesh.h"
#include "planning_io/types/volume.h"
#include "segmentation/bias_field.h"
#include "segmentation/skin_thickness.h"

namespace planlight {

struct SkinSettings {
    double threshold = 0;           ///< HU (or stored units); 0 = found from the histogram
    double seal_radius_mm = 5;      ///< openings narrower than twice this (nostrils, ear canals, mouth) are lidded
    double detach_radius_mm = 2.5;  ///< bridges thinner than twice this to the table or head holder are cut
    double max_edge_mm = 2;         ///< of the finished mesh
    double max_decimation_error_mm = 0.15;
    ThicknessSettings thickness;  ///< of the soft tissue over the bone
};

/// Which voxels are body (1) and which is outside air (0), same order as Volume::values, with what was taken away.
struct SkinMask {
    std::vector<std::uint8_t> body;
    double threshold = 0;    ///< used; of an MR on values freed of `bias`
    BiasField bias;          ///< of an MR whose threshold was not given; else none
    double volume_ml = 0;    ///< of the body
    int pieces_removed = 0;  ///< table, plates, wires: connected pieces cut off
    double removed_ml = 0;
    std::vector<std::string> warnings;  ///< in words
};

/// The body under its outer skin: head-holder plates, table and wires away; nose, ears and mouth filled.
/// Throws InputError when there is no skin in the volume. `progress` (0..1) may be empty.
SkinMask segment_skin(const Volume& volume, const SkinSettings& settings = {},
                      const std::function<void(double)>& progress = {});

/// The outer skin as triangles in ct: sub-voxel on the field's crossing of the threshold, one piece, closed (lids
/// flagged kSeal, volume ends kCutPlane), outward normals, decimated within the bound, with its thickness over the bone
/// (CT in HU).
TriangleMesh triangulate_skin(const Volume& volume, const SkinMask& mask, const SkinSettings& settings = {},
                              const std::function<void(double)>& progress = {});

/// How far noise moves the skin along its normal, mm (1 sigma): the deviation of a voxel within the body (by second
/// differences, which its structure enlarges) over the median slope of the values across the skin. 0 where there is no
/// slope.
double skin_edge_sigma_mm(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin);

}  // namespace planlight
