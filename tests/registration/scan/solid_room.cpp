#include "tests/registration/scan/solid_room.h"

#include <algorithm>
#include <cmath>

#include "tests/registration/scan/solid_optics.h"

namespace planlight::solid_room {
namespace {

Device device(int width, int height, double focal, double k1, const Vector3d& eye, const Vector3d& target) {
    Device d{width, height, focal, width * 0.51, height * 0.48, k1, Eigen::Isometry3d::Identity()};
    const Vector3d z = (target - eye).normalized(), x = Vector3d(0.02, 1, 0).cross(z).normalized(), y = z.cross(x);
    d.device_from_room.linear() << x.transpose(), y.transpose(), z.transpose();
    d.device_from_room.translation() = -d.device_from_room.linear() * eye;
    return d;
}

}  // namespace

Room desk_room(Solid solid, double pixels) {
    const Vector3d target(15, -10, 600);
    const auto size = [&](int n) { return static_cast<int>(std::lround(n * pixels)); };
    Room room;
    room.projector = device(912, 684, 1850, -0.05, Vector3d(0, 0, 0), target);
    room.projector.centre_y = 560;
    room.left = device(size(640), size(480), 1900 * pixels, 0.12, Vector3d(-160, 20, 15), target);
    room.right = device(size(640), size(480), 1930 * pixels, 0.09, Vector3d(150, -35, -10), target);
    room.solid = std::move(solid);
    return room;
}

Cameras::Cameras(const Room& room)
    : left_(room, room.left, room.photography.seed), right_(room, room.right, room.photography.seed + 5000) {}

ScanCapture Cameras::capture(const StripeSettings& stripes, const std::vector<StripePattern>& partial) {
    ScanCapture capture;
    capture.stripes = stripes;
    capture.partial = partial;
    for (const StripePattern& pattern : partial.empty() ? stripe_sequence(stripes) : partial) {
        const std::vector<double> values = shown(stripes, pattern);
        capture.left.push_back(left_.picture(values, pattern.along_rows));
        capture.right.push_back(right_.picture(values, pattern.along_rows));
    }
    return capture;
}

RigCalibration rig_of(const Room& room) {
    const auto model = [](const Device& d) {
        CameraModel m;
        m.width = d.width, m.height = d.height;
        m.focal_x = m.focal_y = d.focal;
        m.centre_x = d.centre_x, m.centre_y = d.centre_y;
        m.k1 = d.k1;
        m.device_from_rig.linear() = d.device_from_room.linear();
        m.device_from_rig.translation() = d.device_from_room.translation();
        return m;
    };
    RigCalibration rig;
    rig.left_camera = model(room.left);
    rig.right_camera = model(room.right);
    rig.projector = model(room.projector);
    return rig;
}

std::vector<double> off_the_solid(const PointCloud& cloud, const Solid& solid) {
    std::vector<double> off;
    for (const Vector3d& p : cloud.points_in_rig) {  // down the slope of the distance: a bound of it is enough
        Vector3d q = p;
        for (int k = 0; k < 30 && std::abs(solid(q)) > 1e-3; ++k) q -= solid(q) * normal_at(solid, q);
        off.push_back((q - p).norm());
    }
    std::sort(off.begin(), off.end());
    return off;
}

}  // namespace planlight::solid_room
