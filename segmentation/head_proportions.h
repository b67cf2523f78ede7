#pragma once

#include <optional>

#include "planning_io/types/triangle_mesh.h"
#include "segmentation/skin_shape.h"

namespace planlight {

/// Proportions of the upper head, to tell a volume whose voxels have not the size that its file says.
struct HeadProportions {
    /// Of the outline at the height of the ball's middle, along its two principal axes: the one nearer to left and
    /// right, and the one nearer to front and back. Heads: 0.7 to 0.95, misshapen ones 0.6 to 1.05.
    double breadth_mm = 0, length_mm = 0, breadth_of_length = 0;
    double turn = 0;  ///< of those axes against the patient's, radians, -45 to 45 degrees
    /// Of the crown above that height, as that of an ellipsoid with the area there: how far it stands up for each
    /// millimetre that it is wide; heads 0.78 to 1.1. Empty where the crown is cut off.
    std::optional<double> height_of_width;
};

/// At the height of the ball's middle, or up to 24 mm above it where the volume ends there. Empty where it cuts off a
/// side of all of these, or no skin is there. `skin` in patient axes.
std::optional<HeadProportions> head_proportions(const TriangleMesh& skin, const HeadBall& ball);

}  // namespace planlight
