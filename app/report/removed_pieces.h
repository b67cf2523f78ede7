#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "app/report/html_page.h"
#include "planning_io/types/volume.h"
#include "segmentation/segment_skin.h"

namespace planlight {

/// Something as dense as skin that is not the body: table, head holder, wire, or a mistake.
struct RemovedPiece {
    double ml = 0;
    Eigen::Vector3d middle_in_ct{0, 0, 0}, low_in_ct{0, 0, 0}, high_in_ct{0, 0, 0};
};

/// What was thrown away, for a person to look at.
struct RemovedPieces {
    std::vector<RemovedPiece> pieces;  ///< connected, of at least 0.05 ml, the largest first
    Eigen::Vector3d body_middle_in_ct{0, 0, 0};
    double ml() const;
    /// The body as a grey shadow with the pieces red and the largest numbered, seen from the front and from the left.
    std::vector<ReportPicture> pictures;
};

/// Voxels over the mask's threshold (of an MR, evened out as the mask says) that the mask does not hold for body.
/// Pictures only where there are pieces.
RemovedPieces find_removed_pieces(const Volume& volume, const SkinMask& mask);

/// Where a piece lies: "in front of the head's middle, 95 mm; to its left, 40 mm".
std::string place_in_words(const Eigen::Vector3d& p_in_ct, const Eigen::Vector3d& middle_in_ct);

}  // namespace planlight
