#pragma once

#include <vector>

#include "registration/matching/scan_cells.h"

namespace planlight {

/// Connected cells on the skin: those that stand alone go, holes are filled, small islands go. One mark per cell of the
/// pieces.
std::vector<char> skin_cells(const CloudPieces& pieces, const ScanCells& scan, const RigidTransform& ct_from_rig);

/// The cells that go on smoothly from the skin found, near the skin of the CT and facing as it does, against those of
/// the skin.
double goes_on(const CloudPieces& pieces, const ScanCells& scan, const RigidTransform& ct_from_rig,
               const std::vector<char>& skin);

}  // namespace planlight
