#pragma once

#include "segmentation/segment_skin.h"

namespace planlight {

/// Where tissues lie in the values of a CT. A cone-beam CT is in HU only roughly: its greys may be shifted by some
/// hundred or stretched (Pauwels et al., "CBCT-based bone quality assessment: are Hounsfield units applicable?",
/// Dentomaxillofac. Radiol. 44, 2015), and brain lie where bone is expected.
struct CtGreys {
    bool usual = true;  ///< soft tissue lies where it does in HU
    double air = -1000, soft = 35;

    /// The value here of what has so many HU: `hu` itself where greys are usual, else by the line through air and soft
    /// tissue.
    double of(double hu) const;
};

/// By the fullest place of the body's values. Usual, too, where no tissue fills the body as a head's does (a dry skull,
/// a phantom), or the volume is not in HU.
CtGreys ct_greys(const Volume& volume, const SkinMask& mask);

}  // namespace planlight
