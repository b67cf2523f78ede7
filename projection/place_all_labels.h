#pragma once

#include <vector>

#include "projection/place_labels.h"

namespace planlight {

/// Puts the labels of a drawing whose strokes are complete, one wish an item. Where there is no skin for all of them
/// whole, some say the name or the item's code alone (`DrawnItem::lit_by_code`), and as a last resort some items have
/// none (`DrawnItem::labelled`). Each item has besides one for when it is the item of the moment (`Label::of_moment`),
/// which minds the plan only.
void place_all_labels(std::vector<LabelWish> wishes, const SkinSurface& skin, const DrawingSettings& settings,
                      PlanDrawing& drawing);

/// How much of the light's area on the skin is text, 0 to 1; of the labels that are always drawn.
double share_of_text(const PlanDrawing& drawing);

}  // namespace planlight
