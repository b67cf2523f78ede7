#pragma once

#include "app/windows/operator_model.h"
#include "app/windows/pen.h"

namespace planlight {

/// Each status has a shape of its own, so that it is known without colour.
void draw_status_shape(const Pen& pen, StatusKind kind, ImVec2 middle, float radius, const BannerLook& look);

}  // namespace planlight
