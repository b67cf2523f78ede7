#include "registration/simulation/optics.h"

#include <gtest/gtest.h>

#include <random>

#include "registration/simulation/rig_layout.h"
#include "tests/registration/opencv_pixel.h"

namespace planlight::simulation {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::opencv_pixel;

namespace {

class OpticsOfPreset : public testing::TestWithParam<Preset> {
protected:
    std::mt19937 random{11};
    RigLayout rig = build_rig(GetParam(), random);
    RigCalibration calibration = exported(rig);
    Vector3d point_in_room() {
        std::uniform_real_distribution<double> x(-150, 150), z(-100, 100);
        return {x(random), x(random), z(random)};
    }
};

}  // namespace

TEST_P(OpticsOfPreset, AgreesWithOpenCvToAMillionthOfAPixel) {
    for (int i = 0; i < 200; ++i) {
        const Vector3d p = point_in_room(), p_in_rig = rig.room_from_rig.inverse() * p;
        EXPECT_LT((rig.left_camera.pixel_of(p) - opencv_pixel(calibration.left_camera, p_in_rig)).norm(), 1e-6);
        EXPECT_LT((rig.right_camera.pixel_of(p) - opencv_pixel(calibration.right_camera, p_in_rig)).norm(), 1e-6);
        EXPECT_LT((rig.projector.pixel_of(p) - opencv_pixel(calibration.projector, p_in_rig)).norm(), 1e-6);
    }
}

TEST_P(OpticsOfPreset, APixelsRayPassesThroughWhatThePixelSees) {
    for (int i = 0; i < 200; ++i)
        for (const Optics* device : {&rig.left_camera, &rig.right_camera, &rig.projector}) {
            const Vector3d p = point_in_room();
            const Vector3d way = device->direction_of(device->pixel_of(p));
            EXPECT_LT(way.cross(p - device->eye).norm(), 1e-6);  // mm
        }
}

TEST_P(OpticsOfPreset, LensesBendLightAndTheProjectorIsShifted) {
    const CameraModel& left = calibration.left_camera;
    EXPECT_LT(left.k1, -0.09);
    EXPECT_NE(left.k1, calibration.right_camera.k1);
    EXPECT_GT(calibration.projector.centre_y, 0.9 * calibration.projector.height);
    // Straight and bent picture of a corner differ by more than a pixel, or the distortion would be untested.
    Optics straight = rig.left_camera;
    straight.radial_per_mm2 = straight.radial_per_mm4 = straight.decentred_x_per_mm = straight.decentred_y_per_mm = 0;
    const Vector3d corner(130, 90, 0);
    EXPECT_GT((straight.pixel_of(corner) - rig.left_camera.pixel_of(corner)).norm(), 1);
}

TEST_P(OpticsOfPreset, AFaultlessCalibrationIsTheTruthAndAGoodOneIsNear) {
    const RigCalibration perfect = calibrated(rig, 0, random);
    EXPECT_EQ(perfect.left_camera.k1, calibration.left_camera.k1);
    EXPECT_TRUE(perfect.projector.device_from_rig.isApprox(calibration.projector.device_from_rig, 1e-15));
    double worst = 0, sum = 0;
    for (int i = 0; i < 40; ++i) {
        const double rms = calibrated(rig, 1, random).reprojection_rms_px;
        worst = std::max(worst, rms);
        sum += rms / 40;
    }
    EXPECT_GT(sum, 0.05);
    EXPECT_LT(sum, 0.25);
    EXPECT_LT(worst, 0.6);
}

INSTANTIATE_TEST_SUITE_P(Presets, OpticsOfPreset, testing::Values(Preset::paper, Preset::modern));

}  // namespace planlight::simulation
