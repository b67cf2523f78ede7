#pragma once

#include <cstdint>
#include <vector>

#include "segmentation/ct_greys.h"
#include "segmentation/skin_shape.h"

namespace planlight {

/// For each vertex of the skin, 1 where the volume ends within something that is no head: at the height of the skull
/// (not the face) no bone lies within 25 mm under the end, nor does bone lie round it in the end's plane, as it does
/// round a brain. A cushion or wet hair that reaches the volume's end. Empty where values are not HU.
std::vector<std::uint8_t> boneless_ends(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin,
                                        const HeadBall& ball, const CtGreys& greys = {});

}  // namespace planlight
