#pragma once

#include "segmentation/skin_judgement.h"

namespace planlight {

/// Adds to `judgement`, whose figures are taken, where the surface is not the skin or is uncertain: a blurred edge, an
/// outline that moves with the threshold, things that lie on the head. In the order in which a person hears them, the
/// ends of the volume come last: `doubt_ends`.
void doubt_surface(const SkinMask& mask, SkinJudgement& judgement);
void doubt_ends(SkinJudgement& judgement);

}  // namespace planlight
