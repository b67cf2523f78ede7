#pragma once

#include "registration/scan/triangulate/triangulate.h"

namespace planlight {

/// Triangulates what both cameras saw without knowing where the projector stands (`rig.projector` is not looked at):
/// its code only says which pixels belong together. With columns only the partner is the place on the epipolar line
/// that has the code. Points carry the code as their projector pixel; distances of the settings count from the left
/// camera. There is no third view to agree: the distance from the epipolar line is the gate, and with columns only
/// there is none.
Triangulation triangulate_cameras(const DecodedView& left, const DecodedView& right, const RigCalibration& rig,
                                  int projector_width, int projector_height,
                                  const TriangulationSettings& settings = {});

}  // namespace planlight
