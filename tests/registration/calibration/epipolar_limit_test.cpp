// The limit of `check_drift` on the epipolar lines against what the error of a good calibration makes of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "registration/calibration/check_drift.h"
#include "registration/simulation/rig_layout.h"
#include "tests/registration/calibration/epipolar_error.h"

namespace planlight {
namespace {

using simulation::Preset;

/// rms over a head's volume in the working point, without noise; one value a calibration.
std::vector<double> epipolar_errors_px(Preset preset, unsigned calibrations) {
    std::vector<double> errors;
    for (unsigned seed = 0; seed < calibrations; ++seed) {
        std::mt19937 random(31 * seed + 5);
        const simulation::RigLayout layout = simulation::build_rig(preset, random);
        const RigCalibration truth = simulation::exported(layout), found = simulation::calibrated(layout, 1, random);
        const RigidTransform rig_from_room = layout.room_from_rig.inverse();
        double squares = 0;
        int count = 0;
        for (const double x : {-80, 0, 80})
            for (const double y : {-80, 0, 80})
                for (const double z : {-40, 40}) {
                    const auto error =
                        test::epipolar_error_px(truth.left_camera, truth.right_camera, found.left_camera,
                                                found.right_camera, rig_from_room * Eigen::Vector3d(x, y, z));
                    if (error) squares += *error * *error, ++count;
                }
        errors.push_back(std::sqrt(squares / std::max(1, count)));
    }
    return errors;
}

double rms(const std::vector<double>& values) {
    double squares = 0;
    for (const double v : values) squares += v * v;
    return std::sqrt(squares / static_cast<double>(values.size()));
}

/// Of a normal distribution one in 16,000 lies beyond four sigmas. 0.15 px in quadrature is left to the noise of the
/// points, twice what the rooms show.
TEST(EpipolarLimit, IsOverFourSigmasOfAGoodCalibration) {
    const double limit_px = DriftLimits{}.epipolar_px, left_px = std::sqrt(limit_px * limit_px - 0.15 * 0.15);
    for (const Preset preset : {Preset::paper, Preset::modern}) {
        const auto errors = epipolar_errors_px(preset, 1000);
        EXPECT_GT(rms(errors), 0.06);  // 0.086 and 0.100: else the rooms would say nothing about the limit
        EXPECT_GT(limit_px, 4 * rms(errors));
        EXPECT_LT(*std::max_element(errors.begin(), errors.end()), left_px);
    }
}

}  // namespace
}  // namespace planlight
