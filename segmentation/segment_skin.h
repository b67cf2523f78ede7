#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/triangle_mesh.h"
#include "planning_io/types/volume.h"
#include "segmentation/level_map.h"
#include "segmentation/skin_thickness.h"

namespace planlight {

/// How the skin is found; all may stay as they are.
struct SkinSettings {
    double threshold = 0;           ///< HU (or stored units); 0 = found from the histogram
    double seal_radius_mm = 5;      ///< openings narrower than twice this (nostrils, ear canals, mouth) are lidded
    double detach_radius_mm = 2.5;  ///< bridges thinner than twice this to the table or head holder are cut
    double max_edge_mm = 2;         ///< of the finished mesh
    double max_decimation_error_mm = 0.15;
    /// A phantom, a dry skull or a plate: of a CT the largest piece is kept whole, and the result is not asked whether
    /// it is a head.
    bool phantom = false;
    ThicknessSettings thickness;  ///< of the soft tissue over the bone
};

/// Which voxels are body (1) and which is outside air (0), same order as Volume::values, with what was taken away.
struct SkinMask {
    std::vector<std::uint8_t> body;
    double threshold = 0;       ///< used; of an MR in units of `levels`: 1
    double threshold_said = 0;  ///< the same in the volume's own unit (of an MR the middle of its levels), for people
    LevelMap levels;            ///< of an MR: air and skin from place to place; else empty
    /// Of an MR: the value that stands for "nothing was measured here" (blanked corners, a blanked face), where it is
    /// not what air shows; in `skin_values` such places are not a number.
    std::optional<float> blank;
    int smoothings = 0;           ///< of an MR: how often its noise was smoothed away before its levels were asked
    double brightness_ratio = 1;  ///< of an MR: the tissue under the skin, brightest place to darkest
    /// Of an MR: share of the outline that moves by over 3 mm between 0.7 and 1.5 times the threshold.
    double unsure_share = 0;
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

/// What the skin's crossing is sought on: the volume itself, or of an MR its values in levels, smoothed as the mask
/// says.
Volume skin_values(const Volume& volume, const SkinMask& mask);

/// The same without smoothing: an MR's values in levels, with its noise.
Volume leveled_values(const Volume& volume, const SkinMask& mask);

/// How far noise moves the skin along its normal, mm (1 sigma): the deviation of a voxel within the body (by second
/// differences, which its structure enlarges) over the median slope of the values across the skin. 0 where there is no
/// slope.
double skin_edge_sigma_mm(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin);

}  // namespace planlight
