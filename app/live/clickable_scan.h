#pragma once

#include <memory>

#include "app/windows/operator_model.h"
#include "planning_io/types/camera_model.h"

namespace planlight {

/// The scan as a surface for landmarks to be clicked on, upright as `seen_by` sees it; without one as from before the
/// skin, the rig's y downwards. Null when its points make no surface.
std::shared_ptr<const ClickableScan> clickable_scan(const PointCloud& cloud, const CameraModel* seen_by = nullptr);

}  // namespace planlight
