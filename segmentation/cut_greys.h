#pragma once

#include "planning_io/types/volume.h"
#include "segmentation/segment_skin.h"

namespace planlight {

/// How much of a volume shows exactly its least value. A scanner's air is never one value, and bone in an MR is not
/// quite black: where both are, the dark end of the greys was cut off (a window for pictures), and with it dim skin.
struct CutGreys {
    double air_share = 0;   ///< of the air within 24 mm of the body
    double body_share = 0;  ///< of what lies deeper than 4 mm in the body
    bool dark_end() const;  ///< both are too many
};

/// Of a volume that is not in HU; else, and where there is no air, nothing is cut.
CutGreys cut_greys(const Volume& volume, const SkinMask& mask);

/// Share of the body that shows exactly the greatest value of a volume not in HU (0 of one in HU). Bone is a tenth of a
/// head and more, and of one value where a CT was saved through a window for pictures.
double bright_end_share(const Volume& volume, const SkinMask& mask);

}  // namespace planlight
