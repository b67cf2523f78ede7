#pragma once

#include <vector>

#include "projection/place_labels.h"

namespace planlight {

/// What a label says: all; all but the distance to a risk structure, or, where that is a warning, the warning without
/// the other figures; that warning without the structure's name; the name alone; or the item's code where there is no
/// room for its name.
enum class LabelForm { whole, spare, brief, name, code };

/// The label would warn of a risk structure: under 2 mm, or through.
bool warns(const LabelWish& wish);

/// The same label in another form.
LabelWish in_form(LabelWish wish, LabelForm form);

/// What is tried in turn, where there is no room for more.
std::vector<LabelForm> forms_of(const LabelWish& wish);

}  // namespace planlight
