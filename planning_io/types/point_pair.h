#pragma once

#include <Eigen/Core>
#include <string>

namespace planlight {

/// A landmark, chosen in the CT and touched (or clicked in the scan) in the operating room.
struct PointPair {
    std::string name;
    Eigen::Vector3d in_ct, in_rig;  ///< mm
};

}  // namespace planlight
