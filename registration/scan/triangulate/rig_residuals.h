#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "planning_io/types/rig_state.h"

// What one scan says of the three devices of a rig, all at once. Private to registration/scan/triangulate.
namespace planlight {

inline constexpr int kRigNumbers = 10 * static_cast<int>(kRigDevices);  ///< a DeviceChange each, by RigDevice
using RigNumbers = Eigen::Matrix<double, kRigNumbers, 1>;
using RigMatrix = Eigen::Matrix<double, kRigNumbers, kRigNumbers>;

/// Every device of the rig by its ten numbers.
RigCalibration changed(const RigCalibration& rig, const RigNumbers& numbers);

/// A place of the skin as the devices see it: the pixels of both cameras and the projector's that lit it.
struct SeenPlace {
    DevicePixels pixels;
    Eigen::Vector3d p_in_rig;  ///< a start for the point
};

/// Normal equations about a rig, the places eliminated.
struct RigResiduals {
    RigMatrix normal = RigMatrix::Zero();
    RigNumbers right = RigNumbers::Zero();
    double chi_square = 0;  ///< truncated, so that a wrong partner counts no more than `kWorstResidual` sigmas
    double usual = 0;       ///< median residual of a place, sigmas of one number
};

/// Gauss-Newton normal equations of all places about a rig: per place the point is eliminated, and three numbers are
/// left: how far each two devices are from the plane they should share, and all three from a point. Places count as
/// `independent` ones together, for what a lens does wrong it does wrong to all its neighbours. The points are moved to
/// where this rig sees them.
RigResiduals rig_residuals(std::vector<SeenPlace>& places, const RigCalibration& rig, double independent);

}  // namespace planlight
