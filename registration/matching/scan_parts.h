#pragma once

#include <vector>

#include "registration/matching/scan_cells.h"

namespace planlight {

/// A part of the scan to be tried alone.
struct ScanPart {
    std::vector<int> cells;  ///< of CloudPieces
    double holds = 0;        ///< how well its shape holds a pose
};

/// Places spread over the scan, each farthest from those before, with the part round each. Those that hold a pose best
/// come first, among some that cover the whole scan thinly and then among the others: the most shapely part of a scan
/// may be crumpled cloth.
std::vector<ScanPart> scan_parts(const CloudPieces& pieces, const ScanCells& scan, const FindSkinSettings& settings);

}  // namespace planlight
