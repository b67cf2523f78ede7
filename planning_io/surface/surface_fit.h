#pragma once

#include <filesystem>
#include <string>

#include "planning_io/types/triangle_mesh.h"
#include "planning_io/types/volume.h"

namespace planlight {

/// How well a surface lies on edges of a volume: places where it grows darker outwards, as from skin to air or from
/// bone to what covers it.
struct SurfaceFit {
    double share_inside = 0;   ///< of its vertices, in the volume
    double share_darker = 0;   ///< of those asked, where it is brighter 1.5 mm under the surface than 1.5 mm over it
    double share_on_edge = 0;  ///< of those asked, within 2 mm of an edge
    double median_mm = 0;      ///< to the nearest edge, along the normal; 10 mm where there is none as near
};

/// Asks some thousand vertices that have the volume on both sides. An edge is a place along the normal, 10 mm both
/// ways, where the volume falls at least 0.4 times as fast as it does at the fastest of a usual (median) vertex. The
/// mesh must have normals, outwards.
SurfaceFit fit_of(const TriangleMesh& surface, const Volume& volume);

/// Checks that the surface belongs to the volume, and gives how well it fits. Throws InputError, with the numbers, when
/// less than 95 % of its vertices lie in the volume (and a voxel about it), or when it lies beside the edges of a CT:
/// less than 75 % of the places are darker outwards or less than 70 % on an edge. (Half are darker outwards of a
/// surface that lies across everything, in another frame; one between skin and bone is everywhere, and on no edge. Of
/// skin that is mirrored or turned by some degrees a half to two thirds are on an edge.) Other volumes than CT are not
/// refused.
SurfaceFit check_surface_fits(const TriangleMesh& surface, const Volume& volume, const std::filesystem::path& file);

/// A warning where less than 85 % of the places are on an edge, in words; else empty.
std::string doubt_of(const SurfaceFit& fit, const std::filesystem::path& file);

}  // namespace planlight
