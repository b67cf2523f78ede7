#pragma once

#include "segmentation/voxel_morphology.h"

namespace planlight {

/// The body without holes through it (an ear's, the gap between an ear and the head): each is closed by a membrane of
/// one voxel, cavities are filled. Its surface, contoured between voxels, is one piece without handles.
///
/// A block over all voxels is carved from outside, layer by layer, down to the largest piece of `body`, taking only
/// voxels that change no connection (simple points; Bertrand & Malandain 1994). Connections are those of marching cubes
/// as VTK's tables have them: body over faces, air over faces and edges.
Mask fill_tunnels(const Mask& body, const VoxelGrid& grid);

}  // namespace planlight
