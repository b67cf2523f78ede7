#include "registration/scan/triangulate/triangulate_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

namespace planlight {
namespace {

using namespace triangulate_kernel;

CameraModel wide_camera(double k1, double k2) {
    CameraModel camera;
    camera.width = camera.height = 2400;
    camera.focal_x = camera.focal_y = 1200;
    camera.centre_x = camera.centre_y = 1199.5;
    camera.k1 = k1;
    camera.k2 = k2;
    return camera;
}

/// Rays up to 45 degrees off the axis, through lenses whose pictures fold back behind 46.6 degrees or never: they meet
/// where they came from.
TEST(TriangulateKernel, TheRimOfAStrongLensIsPlacedToo) {
    for (const auto& [k1, k2] : {std::pair(-0.3, 0.0), {-0.35, 0.12}, {-0.25, 0.08}, {0.2, 0.0}}) {
        const CameraModel camera = wide_camera(k1, k2);
        CameraModel projector = wide_camera(0, 0);
        projector.device_from_rig.translation() = Eigen::Vector3d(-200, 0, 0);
        const auto points = std::make_unique<Points>();
        std::vector<Eigen::Vector3d> truth;
        for (int i = 0; i < kLanes; ++i) {
            const double off_axis = (2 + 43.0 * i / (kLanes - 1)) * M_PI / 180, way = 0.7 * i;
            truth.push_back(800 *
                            Eigen::Vector3d(std::tan(off_axis) * std::cos(way), std::tan(off_axis) * std::sin(way), 1));
            const auto seen = project(camera, truth.back()), lit = project(projector, truth.back());
            ASSERT_TRUE(seen && lit);
            points->pixel_x[i] = seen->x(), points->pixel_y[i] = seen->y();
            points->code_x[i] = lit->x(), points->code_y[i] = lit->y();
            points->sigma[i] = 0;
        }
        start_two(Device(camera), Device(projector), *points);
        for (int step = 0; step < 3; ++step) adjust_two(Device(camera), Device(projector), {0.1, 0.25}, *points);
        for (int i = 0; i < kLanes; ++i) {
            const Eigen::Vector3d found(points->x[i], points->y[i], points->z[i]);
            EXPECT_EQ(points->good[i], 1) << "k1 " << k1 << ", point " << i;
            EXPECT_LT((found - truth[static_cast<std::size_t>(i)]).norm(), 1e-3) << "k1 " << k1 << ", point " << i;
        }
    }
}

}  // namespace
}  // namespace planlight
