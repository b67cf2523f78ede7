#pragma once

#include <vector>

#include "segmentation/ct_greys.h"
#include "segmentation/middle_plane.h"

namespace planlight {

/// What lies under a skin, asked along its inward normals.
struct SkinLayers {
    double layered_share =
        0;  ///< of the vault: bone between scalp and brain (MR: a dark dip; CT: over 300 HU, or a bright crest)
    double scalp_mm = 0;       ///< median depth of the bone under the vault's skin
    double edge_blur_mm = 0;   ///< median way from 80 to 20 % of the step at the skin
    double gap_cm2 = 0;        ///< of skin with at most 3 mm of matter over 3 mm and more of air
    bool bright_bone = false;  ///< of a volume not in HU: the layer is brighter than scalp and brain
    double faint_share =
        0;  ///< of the vault: a layer that is darker than what lies over and under it, if only by a sixth
    bool air_is_blank = false;  ///< what lies before the skin shows one value and no noise
    /// Largest patch of the head's upper part where no bone lies within 16 mm of the skin, square cm; 0 where
    /// bone was not found all over.
    double boneless_cm2 = 0;
    /// Of a volume in HU: patches where what lies just under the surface is lighter than skin and fat (hair, a strap).
    std::vector<Eigen::Vector3d> light_in_ct;  ///< places evenly over them
    double light_cm2 = 0;
    double dip = 0;        ///< median of the darkest place 2 to 16 mm under the vault's skin, as a share of the brain
    double air_share = 0;  ///< of all skin: what lies 3 to 8 mm before it is air
};

/// `centre_in_ct` is the middle of the skull: the vault is what lies above it, or where the volume ends there, the
/// skull's sides and back. Figures that cannot be taken are not a
/// number. `plane`: between left and right. `greys`: where bone and fat lie in a CT.
SkinLayers layers_under(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin,
                        const Eigen::Vector3d& centre_in_ct, const MiddlePlane& plane = {}, const CtGreys& greys = {});

}  // namespace planlight
