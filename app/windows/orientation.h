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

/// The view of somebody who looks from `backward_in_ct` with `up_in_ct` upwards (made perpendicular); both any length,
/// neither along the other.
SceneView view_along(const Eigen::Vector3d& backward_in_ct, const Eigen::Vector3d& up_in_ct);

/// The standard views, by the letter of the side that is looked at: A P L R S; any other: from the front.
SceneView standard_view(char side);

/// Of somebody who stands beside the lying patient and looks down: `away_in_ct` points from him across the patient, the
/// way that labels stand up for him (`DrawingSettings::up_in_ct`); not zero.
SceneView surgeon_view(const Eigen::Vector3d& away_in_ct);

/// The anatomical name of a direction in ct (LPS): R L A P S I, the strongest first, a second when it is at least half
/// of the whole ("RP").
std::string direction_letters(const Eigen::Vector3d& direction_in_ct);

}  // namespace planlight
