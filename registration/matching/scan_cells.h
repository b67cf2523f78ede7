#pragma once

#include <vector>

#include "planning_io/types/rigid_transform.h"
#include "planning_io/types/skin_lut.h"
#include "registration/matching/cloud_pieces.h"
#include "registration/matching/distance_field.h"
#include "registration/matching/find_skin.h"

// A scan as cells of its surfaces, and how they lie on the skin at a pose: what the search among cloth judges by.
namespace planlight {

constexpr double kFacing = 0.6;              ///< cosine between the scan's normal and the skin's, at least
constexpr std::size_t kLeastScanCells = 60;  ///< of a part that is tried: 15 cm^2

/// The cells of a scan that are no strays, in rig. What it refers to must outlive it.
struct ScanCells {
    struct Cell {
        Eigen::Vector3d position, normal;
    };
    std::vector<Cell> cells;
    std::vector<int> of_pieces;  ///< where they are in `CloudPieces::cells`
    std::vector<int> judging;    ///< at most 1200 of them, drawn from the seed: what a pose is judged on at first
    const SkinLut& lut;
    const DistanceField& field;
    const FindSkinSettings& settings;
};
ScanCells scan_cells(const CloudPieces& pieces, const SkinLut& lut, const DistanceField& field,
                     const FindSkinSettings& settings, unsigned seed);

/// Where a cell lies at a pose: beyond what the CT shows; outside of the skin; on it and facing as it does; or so deep
/// in the body that no light comes from there.
enum class CellPlace { beyond, outside, on, inside };
struct CellLying {
    CellPlace place = CellPlace::beyond;
    double mm = 0;  ///< signed distance to the skin, outside positive
};
CellLying lying_of(const ScanCells& scan, const ScanCells::Cell& cell, const RigidTransform& ct_from_rig);

/// What a pose explains of some of the cells: those on the skin, the nearer the more, less those inside.
double explained(const ScanCells& scan, const std::vector<int>& which, const RigidTransform& ct_from_rig);

}  // namespace planlight
