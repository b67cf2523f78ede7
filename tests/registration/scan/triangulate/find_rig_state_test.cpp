#include "registration/scan/triangulate/find_rig_state.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/registration/scan/stripe_room.h"

namespace planlight {
namespace {

using namespace stripe_room;

const Eigen::Vector3d kCentre(120, -40, 360);
constexpr double kRadius_mm = 95;

struct Scanned {
    Room room = paper_room(sphere(kCentre, kRadius_mm));
    RigCalibration rig = rig_of(room);
    ScanCapture shot = capture(room, stripes_of(room));
};

const Scanned& scanned() {
    static const Scanned s;
    return s;
}

/// rig.json of a rig in which this device has been bumped since: the file has it where it no longer is.
RigCalibration bumped(RigDevice device, const Eigen::Vector3d& turn_deg, const Eigen::Vector3d& shift_mm,
                      double focal = 0) {
    RigCalibration rig = scanned().rig;
    DeviceChange change = DeviceChange::Zero();
    change.head<3>() = turn_deg * M_PI / 180;
    change.segment<3>(3) = shift_mm;
    change[6] = focal;
    CameraModel& model = device_of(rig, device);
    model = changed(model, change);
    return rig;
}

const DeviceFinding& finding(const RigState& state, RigDevice device) {
    return state.devices[static_cast<std::size_t>(device)];
}

/// How far from the true place light falls that is sent where a camera's light is seen, by the rig that was found: the
/// points are laid on the true ones as a match would lay them. mm, worst of the places.
double light_off_mm(const RigCalibration& rig) {
    const Truth truth = truth_of(scanned().room, scanned().room.left);
    std::vector<Eigen::Vector3d> found, real;
    std::vector<double> off_mm;
    for (std::size_t i = 0; i < truth.code.size(); i += 211) {
        if (std::isnan(truth.code[i].x())) continue;
        const Eigen::Vector2d left(static_cast<double>(i % 744), static_cast<double>(i / 744));
        const auto right = scanned().room.right.pixels_of({truth.point[i]}).front();
        const auto p = point_of_pixels(rig, {left, right, truth.code[i]}, truth.point[i]);
        if (!p) continue;
        found.push_back(*p);
        real.push_back(truth.point[i]);
    }
    const auto columns = [](const std::vector<Eigen::Vector3d>& points) {
        return Eigen::Matrix3Xd(
            Eigen::Map<const Eigen::Matrix3Xd>(points.front().data(), 3, static_cast<Eigen::Index>(points.size())));
    };
    const RigidTransform found_from_real = fit_rigid_transform(columns(real), columns(found));
    double worst_mm = 0;
    for (std::size_t i = 0; i < found.size(); ++i)
        worst_mm = std::max(worst_mm, (found_from_real * real[i] - found[i]).norm());
    return worst_mm;
}

TEST(FindRigState, AGoodRigIsAsCalibrated) {
    const ScanResult scan = scan_from_capture(scanned().shot, scanned().rig);
    EXPECT_EQ(scan.rig.verdict, RigState::Verdict::as_calibrated) << scan.rig.sentence;
    EXPECT_LT(scan.rig.hidden_light_mm, 0.15) << "what a good calibration leaves";
    for (const DeviceFinding& device : scan.rig.devices) EXPECT_FALSE(device.moved || device.maybe);
}

/// A camera turned upwards by little enough that the calibration's own error may explain it: by rig.json as it is the
/// rays of the two cameras miss each other by several sigmas, and most points would go.
TEST(FindRigState, ARigThatHoldsWithinItsCalibrationsErrorLosesNoPoints) {
    const std::size_t all = scan_from_capture(scanned().shot, scanned().rig).clean.kept.size();
    for (const double turn_deg : {0.01, 0.02, 0.03, 0.04}) {
        RigCalibration rig = bumped(RigDevice::left_camera, {turn_deg, 0, 0}, {0, 0, 0});
        rig.reprojection_rms_px = 0.3;
        const ScanResult scan = scan_from_capture(scanned().shot, rig);
        EXPECT_TRUE(scan.rig.checked()) << scan.rig.sentence;
        EXPECT_GT(scan.clean.kept.size(), all * 9 / 10) << turn_deg << " degrees: " << scan.rig.sentence;
        EXPECT_LT(light_off_mm(scan.rig.rig), 0.2) << turn_deg << " degrees: " << scan.rig.sentence;
    }
}

/// Turned, shifted and zoomed; the light of the rig that is found lands where it is sent.
TEST(FindRigState, AProjectorThatWasBumpedIsFoundAndNamed) {
    for (const auto& [turn, shift, focal] : {std::tuple{Eigen::Vector3d(0.2, 0.1, 0), Eigen::Vector3d(0, 0, 0), 0.0},
                                             std::tuple{Eigen::Vector3d(-0.5, 0.4, 0.6), Eigen::Vector3d(0, 0, 0), 0.0},
                                             std::tuple{Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 2, -2), 0.0},
                                             std::tuple{Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, 0, 0), 0.02}}) {
        const ScanResult scan = scan_from_capture(scanned().shot, bumped(RigDevice::projector, turn, shift, focal));
        EXPECT_EQ(scan.rig.verdict, RigState::Verdict::corrected) << scan.rig.sentence;
        EXPECT_TRUE(finding(scan.rig, RigDevice::projector).moved) << scan.rig.sentence;
        EXPECT_EQ(finding(scan.rig, RigDevice::projector).lens, focal != 0) << scan.rig.sentence;
        EXPECT_LT(light_off_mm(scan.rig.rig), 0.1) << scan.rig.sentence;
    }
}

/// Off the epipolar lines: nothing but that camera explains it.
TEST(FindRigState, ACameraThatWasBumpedIsFoundAndNamed) {
    for (const RigDevice device : {RigDevice::left_camera, RigDevice::right_camera})
        for (const double degrees : {0.1, -0.7}) {
            const ScanResult scan =
                scan_from_capture(scanned().shot, bumped(device, {degrees, degrees / 2, 0}, {0, 0, 0}));
            EXPECT_EQ(scan.rig.verdict, RigState::Verdict::corrected) << scan.rig.sentence;
            EXPECT_TRUE(finding(scan.rig, device).moved) << scan.rig.sentence;
            EXPECT_NEAR(finding(scan.rig, device).turned * 180 / M_PI, std::hypot(degrees, degrees / 2), 0.02);
            EXPECT_LT(light_off_mm(scan.rig.rig), 0.2) << scan.rig.sentence;
            EXPECT_GT(scan.clean.kept.size(), 10000u) << "the cloud is made with the rig that was found";
        }
}

/// The epipolar lines stay; the cloud is bent, or the projector seems to have moved. Whichever it says: the light it
/// would draw is no farther off than it says.
TEST(FindRigState, ACameraTurnedSidewaysHidesNoMoreThanIsSaid) {
    for (const RigDevice device : {RigDevice::left_camera, RigDevice::right_camera})
        for (const double degrees : {-0.3, -0.1, -0.05, 0.05, 0.1, 0.3}) {
            const ScanResult scan = scan_from_capture(scanned().shot, bumped(device, {0, degrees, 0}, {0, 0, 0}));
            ASSERT_TRUE(scan.rig.moved()) << degrees << ": " << scan.rig.sentence;
            EXPECT_TRUE(finding(scan.rig, device).moved || finding(scan.rig, device).maybe) << scan.rig.sentence;
            EXPECT_LT(light_off_mm(scan.rig.rig), 1.2 * scan.rig.hidden_light_mm + 0.1)
                << degrees << ": " << scan.rig.sentence;
        }
}

/// The scale of the whole is seen by no scan: a camera shifted along the line to the other is a projector shifted along
/// the line to the camera that stayed. Both are named, and what it hides is the scale's part.
TEST(FindRigState, WhatOnlyChangesTheScaleIsSaidWithWhatItHides) {
    const Eigen::Vector3d left = scanned().rig.left_camera.centre_in_rig(),
                          right = scanned().rig.right_camera.centre_in_rig();
    const double shift_mm = 4, scale = shift_mm / (right - left).norm();
    const Eigen::Vector3d along = scanned().rig.left_camera.device_from_rig.linear() * (right - left).normalized();
    const ScanResult scan =
        scan_from_capture(scanned().shot, bumped(RigDevice::left_camera, {0, 0, 0}, shift_mm * along));
    ASSERT_TRUE(scan.rig.moved()) << scan.rig.sentence;
    EXPECT_TRUE(finding(scan.rig, RigDevice::left_camera).maybe) << scan.rig.sentence;
    EXPECT_TRUE(finding(scan.rig, RigDevice::projector).maybe) << scan.rig.sentence;
    EXPECT_GT(scan.rig.hidden_light_mm, 0.3 * scale * kRadius_mm) << scan.rig.sentence;
    EXPECT_EQ(scan.rig.verdict, scan.rig.hidden_light_mm > RigStateSettings{}.max_hidden_mm
                                    ? RigState::Verdict::not_trusted
                                    : RigState::Verdict::corrected);
}

/// Warmth, or a person who focused both: to one scan that is a projector's lens as well. Whichever is taken, both
/// cameras' lenses are named, and the light is no farther off than is said.
TEST(FindRigState, BothCamerasLensesChangedAlikeHideNoMoreThanIsSaid) {
    for (const double focal : {0.002, 0.0037, -0.0037}) {
        RigCalibration rig = bumped(RigDevice::left_camera, {0, 0, 0}, {0, 0, 0}, focal);
        rig.right_camera = bumped(RigDevice::right_camera, {0, 0, 0}, {0, 0, 0}, focal).right_camera;
        const ScanResult scan = scan_from_capture(scanned().shot, rig);
        EXPECT_NE(scan.rig.sentence.find("both cameras' lenses were changed"), std::string::npos)
            << focal << ": " << scan.rig.sentence;
        EXPECT_LT(light_off_mm(scan.rig.rig), 1.2 * scan.rig.hidden_light_mm + 0.1)
            << focal << ": " << scan.rig.sentence;
    }
}

TEST(FindRigState, ColumnsOnlyCannotTell) {
    StripeSettings columns = stripes_of(scanned().room);
    columns.rows = false;
    const ScanResult scan = scan_from_capture(capture(scanned().room, columns), scanned().rig);
    EXPECT_EQ(scan.rig.verdict, RigState::Verdict::unknown);
    EXPECT_NE(scan.rig.sentence.find("columns"), std::string::npos) << scan.rig.sentence;
}

}  // namespace
}  // namespace planlight
