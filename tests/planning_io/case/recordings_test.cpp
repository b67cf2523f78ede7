#include <gtest/gtest.h>

#include <limits>

#include "planning_io/case/capture_folder.h"
#include "planning_io/case/frames_folder.h"
#include "planning_io/case/poses_file.h"
#include "planning_io/case/registration_file.h"
#include "planning_io/files/image_file.h"
#include "planning_io/types/error.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

TEST(Recordings, CaptureFramesRegistrationAndPosesReadBack) {
    const test::TemporaryFolder folder;
    CaptureFolder capture;
    capture.projector_width = 1920;
    capture.projector_height = 1080;
    capture.rows = false;
    capture.names = {"white", "gray_0", "phase_0"};
    for (std::uint8_t i = 0; i < 3; ++i)
        capture.left.emplace_back(8, 6, i), capture.right.emplace_back(8, 6, static_cast<std::uint8_t>(100 + i));
    capture.began = Instant(123456789012345);
    write_capture(capture, folder.path() / "capture");
    const CaptureFolder back = read_capture(folder.path() / "capture");
    EXPECT_EQ(back.names, capture.names);
    EXPECT_EQ(back.right[2].pixels, capture.right[2].pixels);
    EXPECT_EQ(back.began, capture.began);
    EXPECT_FALSE(back.rows);
    EXPECT_THROW(write_capture(capture, folder.path() / "capture"), InputError) << "never over another recording";
    write_png(GrayImage(9, 6), folder.path() / "capture" / "left" / "phase_0.png");
    EXPECT_THROW(read_capture(folder.path() / "capture"), InputError) << "a picture of another size";
    capture.names[1] = "../../escape";
    EXPECT_THROW(write_capture(capture, folder.path() / "other"), InputError);

    std::vector<StereoFrame> frames(2);
    frames[0] = {GrayImage(4, 4, 1), GrayImage(4, 4, 2), Instant(1000), Instant(50), 7};
    frames[1] = {GrayImage(4, 4, 3), GrayImage(4, 4, 4), Instant(2000), Instant(50), 9};
    write_frames(frames, folder.path() / "frames");
    const auto frames_back = read_frames(folder.path() / "frames");
    ASSERT_EQ(frames_back.size(), 2u);
    EXPECT_EQ(frames_back[1].number, 9u);
    EXPECT_EQ(frames_back[1].right.pixels, frames[1].right.pixels);
    EXPECT_EQ(frames_back[0].at, Instant(1000));

    RegistrationResult result;
    result.verdict = Verdict::ask;
    result.reasons = {"The chin is missing."};
    result.patient_from_ct = Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.3, Vector3d(1, 2, 2) / 3);
    result.points = 12345;
    result.covariance.of_turn_and_shift = Eigen::Matrix<double, 6, 6>::Random();
    result.covariance.of_turn_and_shift.diagonal().setConstant(3);
    result.covariance.centre_in_ct = {7, 8, 9};
    result.runner_up_ratio = std::numeric_limits<double>::infinity();
    result.landmarks_off_mm = 2.5;
    result.moved_in_scan_mm = 0.07;  // and the viewpoint was not said
    result.judged_points = 1234, result.skin_fraction = 0.1;
    result.weakest_sigma_mm = 0.4;  // and whether the head has the CT's shape is not known
    result.skin.apart_mm = 4, result.skin.alike_over_mm = 25;
    result.skin.offset_mm = -0.35, result.skin.spread_mm = 0.08;
    result.skin.places = {{{10.126, -20, 30}, -0.31254, 0.02}, {{14, -20, 30.5}, -0.4, 0.05}};
    result.skin.covered = {{{18, -20, 31}, 7.25}};
    write_registration(result, folder.path() / "registration.json");
    const auto result_back = read_registration(folder.path() / "registration.json");
    EXPECT_EQ(result_back.verdict, Verdict::ask);
    EXPECT_EQ(result_back.patient_from_ct.matrix(), result.patient_from_ct.matrix());
    EXPECT_EQ(result_back.reasons, result.reasons);
    EXPECT_EQ(result_back.covariance.of_turn_and_shift, result.covariance.of_turn_and_shift);
    EXPECT_EQ(result_back.covariance.centre_in_ct, result.covariance.centre_in_ct);
    EXPECT_EQ(predicted_error(result_back.covariance, {0, 0, 50}).bound_95_mm,
              predicted_error(result.covariance, {0, 0, 50}).bound_95_mm);
    EXPECT_GT(result_back.runner_up_ratio, 1e100);
    EXPECT_EQ(result_back.landmarks_off_mm, 2.5);
    EXPECT_EQ(result_back.moved_in_scan_mm, 0.07);
    EXPECT_FALSE(result_back.blocked_fraction);
    EXPECT_EQ(result_back.judged_points, 1234U);
    EXPECT_EQ(result_back.skin_fraction, 0.1);
    EXPECT_EQ(result_back.weakest_sigma_mm, 0.4);
    EXPECT_FALSE(result_back.shape_change_mm);
    ASSERT_EQ(result_back.skin.places.size(), 2u);
    EXPECT_EQ(result_back.skin.offset_mm, -0.35);
    EXPECT_EQ(result_back.skin.alike_over_mm, 25);
    EXPECT_LT((result_back.skin.places[0].p_in_ct - result.skin.places[0].p_in_ct).norm(), 0.01);
    EXPECT_NEAR(result_back.skin.places[0].mm, -0.31254, 1e-4);
    EXPECT_EQ(result_back.skin.places[1].sigma_mm, 0.05);
    ASSERT_EQ(result_back.skin.covered.size(), 1u);
    EXPECT_EQ(result_back.skin.covered[0].p_in_ct, Eigen::Vector3d(18, -20, 31));
    EXPECT_EQ(result_back.skin.covered[0].mm, 7.25);

    result.covariance.of_turn_and_shift.diagonal().setConstant(std::numeric_limits<double>::infinity());
    write_registration(result, folder.path() / "not_known.json");
    const auto not_known = read_registration(folder.path() / "not_known.json");
    EXPECT_TRUE(std::isinf(predicted_error(not_known.covariance, {0, 0, 50}).bound_95_mm))
        << "a pose of which nothing is known may be off by anything, also out of a file";

    std::vector<TrackedPose> poses(2);
    poses[0].rig_from_patient = result.patient_from_ct;
    poses[0].at = Instant(5);
    poses[0].predicted_error_mm = 0.1, poses[0].bound_95_mm = 0.17;
    poses[1].reason = "fewer than 3 markers in the left picture";
    write_poses(poses, folder.path() / "poses.json");
    const auto poses_back = read_poses(folder.path() / "poses.json");
    EXPECT_EQ(poses_back[0].rig_from_patient->matrix(), result.patient_from_ct.matrix());
    EXPECT_EQ(poses_back[0].bound_95_mm, 0.17);
    EXPECT_FALSE(poses_back[1].rig_from_patient);
    EXPECT_EQ(poses_back[1].reason, poses[1].reason);
}

}  // namespace
}  // namespace planlight
