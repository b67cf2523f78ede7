#pragma once

#include <Eigen/Core>
#include <string>

#include "app/windows/operator_model.h"

namespace planlight {

/// The axes of a view in ct (LPS): unit vectors, right-handed with `backward` towards the viewer.
struct ViewAxes {
    Eigen::Vector3d right_in_ct, up_in_ct, backward_in_ct;
};

/// Of the view's camera, unit length.
ViewAxes axes_of(const SceneView& view);

/// The anatomical name of a direction in ct (LPS): R L A P S I, the strongest first, a second when it is at least half
/// of the whole ("RP").
std::string direction_letters(const Eigen::Vector3d& direction_in_ct);

}  // namespace planlight
