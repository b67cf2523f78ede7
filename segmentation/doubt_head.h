#pragma once

#include "segmentation/head_proportions.h"
#include "segmentation/middle_plane.h"
#include "segmentation/skin_judgement.h"
#include "segmentation/skin_layers.h"
#include "segmentation/skin_shape.h"

namespace planlight {

/// Adds to `judgement`, whose figures are taken, whether what was found is a head: its size and proportions, scalp over
/// bone over brain, a nose in front, and whether it is the only one.
void doubt_head(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin, const HeadBall& ball,
                const MiddlePlane& plane, const SkinLayers& layers, SkinJudgement& judgement);

}  // namespace planlight
