#pragma once

#include <Eigen/Core>
#include <vector>

#include "projection/draw_plan.h"
#include "projection/skin_surface.h"

namespace planlight {

/// Where short strokes could be lit about an item, which the cameras find where they do not find the item itself.
struct MarkPlace {
    struct Ray {
        Eigen::Vector3d direction_in_ct;  ///< along the skin
        double from_mm = 0;               ///< from `at` to the mark's near end, along the skin
    };
    int item = -1;  ///< index into PlanDrawing::items
    Rgb colour{255, 255, 255};
    SkinSurface::Point at;
    std::vector<Ray> rays;  ///< those that are wanted most first
    int wanted = 4;         ///< no more marks than this
    double length_mm = 5;   ///< of a mark
};

/// For each item, true where the cameras cannot tell by its strokes where its light lies in both directions along the
/// skin (`segments_of`).
std::vector<bool> untold_items(const PlanDrawing& drawing);

/// Adds strokes of the kind `check_mark` to each item whose own strokes are too small, or too near to each other, for
/// the cameras to tell by them (`untold_items`): a hole of a few millimetres, a way in, a short line. A mark is left
/// out where it would come near any other light, label, or place that is kept clear, so that an item in a crowd may go
/// without.
void add_check_marks(const std::vector<MarkPlace>& places, const SkinSurface& skin, const DrawingSettings& settings,
                     PlanDrawing& drawing);

}  // namespace planlight
