#pragma once

#include <string>
#include <vector>

#include "planning_io/types/point_cloud.h"

namespace planlight::test {

/// Ways in which skin moves between CT and operation. Some were looked at while the prediction of the error was built
/// (`tuned_on`), the others only to measure it.
struct SkinMovement {
    std::string name;
    bool tuned_on;
};
const std::vector<SkinMovement>& skin_movements();
/// A way that is not among those: the pose takes up a good part of it.
inline const std::string kSwollenSide = "one side swollen";

/// The cloud (in ct, with normals) as `movement` leaves it; `rms_mm` is its size over the cloud, along the normals (the
/// swellings and the jaw: their largest is about twice that).
PointCloud with_moved_skin(const PointCloud& cloud_in_ct, const std::string& movement, double rms_mm, unsigned seed);

}  // namespace planlight::test
