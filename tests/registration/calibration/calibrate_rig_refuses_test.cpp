#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "registration/calibration/calibrate_rig.h"
#include "registration/calibration/initial_calibration.h"
#include "tests/registration/calibration/ideal_board.h"

namespace planlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::calibrated;

/// Expects a refusal whose reason and remedy are there, and whose reason holds `words`.
void expect_refused(const Calibration& calibration, const std::string& words) {
    ASSERT_TRUE(calibration.refusal.has_value()) << "not refused; expected: " << words;
    EXPECT_NE(calibration.refusal->reason.find(words), std::string::npos) << calibration.refusal->reason;
    EXPECT_FALSE(calibration.refusal->remedy.empty());
}

TEST(CalibrateRigRefuses, TooFewPoses) {
    expect_refused(calibrated(test::ideal_room(2), test::ideal_room(2).observe()), "2 of 2 poses");
}

TEST(CalibrateRigRefuses, NoPoseAtAll) {
    expect_refused(calibrate_rig({}, parse_board("charuco 10x7 25 mm"), 800, 600), "0 of 0 poses");
}

TEST(CalibrateRigRefuses, TheSamePoseAgainAndAgain) {
    test::IdealRoom room = test::ideal_room();
    for (auto& pose : room.rig_from_board) pose = room.rig_from_board.front();
    expect_refused(calibrated(room, room.observe()), "1 different");
}

TEST(CalibrateRigRefuses, BoardsFlatOn) {
    test::IdealRoom room = test::ideal_room(8, 1);
    for (auto& pose : room.rig_from_board) {  // flat on to the left camera
        const Vector3d middle = pose * Vector3d(125, 87.5, 0);
        pose.linear() =
            room.rig.left_camera.device_from_rig.linear().transpose() *
            Eigen::AngleAxisd(0.3 * static_cast<double>(&pose - room.rig_from_board.data()), Vector3d::UnitZ())
                .toRotationMatrix();
        pose.translation() = middle - pose.linear() * Vector3d(125, 87.5, 0);
    }
    expect_refused(calibrated(room, room.observe()), "flat on");
}

TEST(CalibrateRigRefuses, PosesTiltedAllTheSameWay) {
    test::IdealRoom room = test::ideal_room();
    for (std::size_t i = 0; i < room.rig_from_board.size(); ++i) {
        RigidTransform& pose = room.rig_from_board[i];
        const Vector3d middle = pose * Vector3d(125, 87.5, 0);
        pose.linear() = (Eigen::AngleAxisd(0.5 + 0.01 * static_cast<double>(i), Vector3d(0.6, 0.8, 0)) *
                         Eigen::AngleAxisd(0.3 * static_cast<double>(i), Vector3d::UnitZ()))
                            .toRotationMatrix();
        pose.translation() = middle - pose.linear() * Vector3d(125, 87.5, 0);
    }
    expect_refused(calibrated(room, room.observe()), "too similar");
}

/// Where scanned points lie may be known while nobody knows where light falls: it is the light that is uncertain then.
TEST(CalibrateRigRefuses, LightThatThePosesDoNotPlace) {
    test::IdealRoom room = test::ideal_room(4);
    room.noise_px = 0.01, room.light_noise_px = 0.5;
    const auto poses = room.observe();
    const Calibration found = calibrated(room, poses);
    ASSERT_FALSE(found.refusal) << found.refusal->reason;
    ASSERT_GT(found.volume->light_p95_mm, found.volume->p95_mm);
    CalibrationSettings strict;
    strict.max_predicted_mm = (found.volume->light_p95_mm + found.volume->p95_mm) / 2;
    expect_refused(calibrate_rig(poses, room.board, room.rig.projector.width, room.rig.projector.height, strict),
                   "the light would be uncertain");
}

TEST(CalibrateRigRefuses, ABoardOfAnotherCount) {
    const test::IdealRoom room = test::ideal_room(8, 25, "charuco 10x7 25 mm");
    const BoardSpec wrong = parse_board("charuco 9x7 25 mm");
    auto poses = room.observe();
    for (auto& pose : poses)
        for (auto* seen : {&pose.left, &pose.right})
            while (seen->corners.ids.back() >= wrong.corner_count())
                seen->corners.ids.pop_back(), seen->corners.pixels.pop_back();
    expect_refused(calibrate_rig(poses, wrong, 800, 600), "do not lie as on a charuco 9x7");
}

/// A printer whose feed is long: the cameras' pixels seem to be wider than high, both alike, and nothing else is odd.
TEST(CalibrateRigRefuses, ABoardThatWasStretchedInPrinting) {
    const auto of_board = [](double stretch) {
        test::IdealRoom room = test::ideal_room();
        for (RigidTransform& pose : room.rig_from_board) {  // the same way up in all poses, as most people hold it
            const Vector3d middle = pose * Vector3d(125, 87.5, 0), normal = pose.linear().col(2);
            pose.linear() = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), normal).toRotationMatrix();
            pose.linear().col(1) *= stretch;
            pose.translation() = middle - pose.linear() * Vector3d(125, 87.5, 0);
        }
        return calibrated(room, room.observe(), false);
    };
    const auto says = [](const Calibration& c) {
        return std::ranges::any_of(c.warnings,
                                   [](const std::string& w) { return w.find("its height") != std::string::npos; });
    };
    const Calibration good = of_board(1), bad = of_board(1.0035);
    ASSERT_FALSE(good.refusal) << good.refusal->reason;
    EXPECT_FALSE(says(good));
    ASSERT_FALSE(bad.refusal) << bad.refusal->reason;
    EXPECT_TRUE(says(bad));
    expect_refused(of_board(1.01), "longer in its height");
    expect_refused(of_board(0.99), "shorter in its height");
}

/// As the guide tells people to hold it: rolled from pose to pose. Then it contradicts itself as moved cameras do.
TEST(CalibrateRigRefuses, AStretchedBoardThatWasRolledBetweenThePoses) {
    for (const double stretch : {1.003, 0.995, 1.01, 1.03}) {
        test::IdealRoom room = test::ideal_room();
        room.noise_px = 0.02;
        for (RigidTransform& pose : room.rig_from_board) pose.linear().col(1) *= stretch;
        const Calibration found = calibrated(room, room.observe(), false);
        expect_refused(found, stretch > 1 ? "longer in its height" : "shorter in its height");
        ASSERT_TRUE(found.refusal);
        EXPECT_NE(found.refusal->reason.find(fmt::format("{:.1f} %", 100 * std::abs(stretch - 1))), std::string::npos)
            << found.refusal->reason;
    }
}

/// A lens whose focal length changed by 0.2 % in the last two poses of thirteen: the first adjustment shows but one of
/// them.
TEST(CalibrateRigRefuses, AllPosesAreNamedInWhichALensWasChanged) {
    for (const double change : {1.002, 1.003}) {
        test::IdealRoom room = test::ideal_room(13);
        room.noise_px = 0.02;
        test::IdealRoom zoomed = room;
        zoomed.rig.left_camera.focal_x *= change;
        zoomed.rig.left_camera.focal_y *= change;
        auto poses = room.observe();
        const auto after = zoomed.observe();
        poses[11] = after[11], poses[12] = after[12];
        const Calibration found = calibrated(room, poses, false);
        expect_refused(found, "corners of pose-11, pose-12 contradict");
        ASSERT_TRUE(found.refusal);
        EXPECT_NE(found.refusal->reason.find("or its zoom or focus changed"), std::string::npos);
        EXPECT_NE(found.refusal->remedy.find("take pose-11, pose-12 out"), std::string::npos);
    }
}

TEST(CalibrateRigRefuses, AColourCamerasRawPictures) {
    const test::IdealRoom room = test::ideal_room();
    auto poses = room.observe();
    for (PoseObservation& pose : poses) pose.right.colour_mosaic = true, pose.right.corners = {};
    expect_refused(calibrated(room, poses), "pose-00, right camera: these are raw pictures of a colour camera");
}

TEST(CalibrateRigRefuses, CamerasThatAreSwapped) {
    const test::IdealRoom room = test::ideal_room();
    auto poses = room.observe();
    for (auto& pose : poses) std::swap(pose.left, pose.right);
    expect_refused(calibrated(room, poses), "swapped");
}

TEST(CalibrateRigRefuses, AMirroredCamera) {
    // A chessboard's mirror image is a chessboard: only the other camera can tell. Its corners come in mirrored order,
    // too.
    const test::IdealRoom room = test::ideal_room(8, 25, "chessboard 9x7 20 mm");
    auto poses = room.observe();
    const int across = room.board.corners_across();
    for (auto& pose : poses) {
        BoardCorners mirrored;
        for (int id = 0; id < room.board.corner_count(); ++id) {
            const int other = id / across * across + across - 1 - id % across;
            const auto& c = pose.right.corners;
            const auto at = std::find(c.ids.begin(), c.ids.end(), other);
            if (at == c.ids.end()) continue;
            mirrored.ids.push_back(id);
            mirrored.pixels.emplace_back(
                pose.right.width - 1 - c.pixels[static_cast<std::size_t>(at - c.ids.begin())].x(),
                c.pixels[static_cast<std::size_t>(at - c.ids.begin())].y());
        }
        pose.right.corners = mirrored;
    }
    expect_refused(calibrated(room, poses), "mirrored");
}

TEST(CalibrateRigRefuses, AMirroredCameraByItsMarkers) {
    const test::IdealRoom room = test::ideal_room();
    auto poses = room.observe();
    for (auto& pose : poses) {
        pose.left.corners = {};
        pose.left.found_mirrored = true;
    }
    expect_refused(calibrated(room, poses), "left camera's pictures are mirrored");
}

/// Both cameras flipped alike are rarer than a page that was printed for a window or a transfer.
TEST(CalibrateRigRefuses, ABoardThatWasPrintedMirrored) {
    const test::IdealRoom room = test::ideal_room();
    auto poses = room.observe();
    for (auto& pose : poses)
        for (auto* seen : {&pose.left, &pose.right}) seen->corners = {}, seen->found_mirrored = true;
    expect_refused(calibrated(room, poses), "both cameras see the board mirrored: it was printed mirrored");
}

TEST(CalibrateRigRefuses, AMirroredProjector) {
    const test::IdealRoom room = test::ideal_room();
    auto poses = room.observe();
    for (auto& pose : poses)
        for (auto* seen : {&pose.left, &pose.right})
            for (LightSample& sample : seen->light)
                sample.pixel_in_projector.x() = room.rig.projector.width - 1 - sample.pixel_in_projector.x();
    expect_refused(calibrated(room, poses), "projector's picture is mirrored");
}

/// From pose 5 on a camera stands a tenth of a degree (4 px) otherwise.
TEST(CalibrateRigRefuses, ACameraMovedBetweenPoses) {
    const test::IdealRoom room = test::ideal_room();
    test::IdealRoom knocked = room;
    knocked.rig.right_camera.device_from_rig =
        Eigen::AngleAxisd(0.1 * M_PI / 180, Vector3d::UnitY()) * room.rig.right_camera.device_from_rig;
    auto poses = room.observe();
    const auto after = knocked.observe();
    for (std::size_t i = 5; i < poses.size(); ++i) poses[i] = after[i];
    expect_refused(calibrated(room, poses), "moved between poses");
}

TEST(CalibrateRigRefuses, AProjectorMovedBetweenPoses) {
    const test::IdealRoom room = test::ideal_room();
    test::IdealRoom knocked = room;
    knocked.rig.projector.device_from_rig =
        Eigen::AngleAxisd(0.2 * M_PI / 180, Vector3d::UnitY()) * room.rig.projector.device_from_rig;
    auto poses = room.observe();
    const auto after = knocked.observe();
    for (std::size_t i = 4; i < poses.size(); ++i) poses[i] = after[i];
    expect_refused(calibrated(room, poses), "the light does not fit");
}

/// One pose of 13 is 8 % of what was seen: neither a share of all nor a median feels it, and a rig.json would say where
/// the device stood before.
TEST(CalibrateRigRefuses, ADeviceKnockedBeforeTheLastPoseOrAfterTheFirst) {
    for (const char* board : {"chessboard 9x6 25 mm", "charuco 10x7 25 mm"})
        for (const DeviceName name : {DeviceName::left_camera, DeviceName::right_camera, DeviceName::projector}) {
            const test::IdealRoom room = test::ideal_room(13, 25, board);
            test::IdealRoom knocked = room;
            CameraModel& device = name == DeviceName::projector     ? knocked.rig.projector
                                  : name == DeviceName::left_camera ? knocked.rig.left_camera
                                                                    : knocked.rig.right_camera;
            device.device_from_rig = Eigen::AngleAxisd(0.3 * M_PI / 180, Vector3d::UnitY()) * device.device_from_rig;
            const auto before = room.observe(), after = knocked.observe();
            auto last = before;
            last.back() = after.back();
            const Calibration at_the_end = calibrated(room, last);
            expect_refused(at_the_end, "moved before pose-12");
            EXPECT_NE(at_the_end.refusal->remedy.find("take pose-12 out of the folder"), std::string::npos);
            auto first = after;
            first.front() = before.front();
            expect_refused(calibrated(room, first), "moved after pose-00");
            auto two = before;
            two[11] = after[11], two[12] = after[12];
            expect_refused(calibrated(room, two), "moved");
        }
}

/// Nobody moved anything: the light of one pose is that of another picture. The sentence leaves that open.
TEST(CalibrateRigRefuses, OnePoseWithBadPictures) {
    const test::IdealRoom room = test::ideal_room(13);
    auto poses = room.observe();
    for (auto* seen : {&poses[5].left, &poses[5].right})
        for (LightSample& sample : seen->light) sample.pixel_in_projector += Vector2d(16, 0);
    const Calibration found = calibrated(room, poses);
    expect_refused(found, "the projector's light of pose-05 contradicts");
    EXPECT_NE(found.refusal->reason.find("or the pictures of that pose are bad"), std::string::npos);
    poses.erase(poses.begin() + 5);
    EXPECT_FALSE(calibrated(room, poses).refusal) << "as the remedy says";
}

/// A hundredth of a degree is 0.4 px, 0.16 mm on the patient: five times the noise, and no reason to be content.
TEST(CalibrateRigRefuses, AHundredthOfADegreeOfACameraOrTheProjector) {
    const test::IdealRoom room = test::ideal_room();
    for (const bool projector : {false, true}) {
        test::IdealRoom knocked = room;
        CameraModel& device = projector ? knocked.rig.projector : knocked.rig.right_camera;
        device.device_from_rig =
            Eigen::AngleAxisd((projector ? 0.01 : 0.02) * M_PI / 180, Vector3d::UnitX()) * device.device_from_rig;
        auto poses = room.observe();
        const auto after = knocked.observe();
        for (std::size_t i = 4; i < poses.size(); ++i) poses[i] = after[i];
        expect_refused(calibrated(room, poses), "moved between poses");
    }
}

TEST(CalibrateRigRefuses, PicturesOfDifferentPosesPairedUp) {
    const test::IdealRoom room = test::ideal_room();
    auto poses = room.observe();
    const auto first = poses.front().right;
    for (std::size_t i = 0; i + 1 < poses.size(); ++i) poses[i].right = poses[i + 1].right;
    poses.back().right = first;
    expect_refused(calibrated(room, poses), "of different poses");
}

TEST(CalibrateRigRefuses, SaturatedDimMovedAndUndecodedPictures) {
    const test::IdealRoom room = test::ideal_room();
    const auto good = room.observe();
    auto poses = good;
    poses[2].right.saturated_share = 0.2;
    expect_refused(calibrated(room, poses), "pose-02, right camera: 20 % of the board is saturated");
    poses = good;
    poses[3].left.contrast_grey = 5;
    expect_refused(calibrated(room, poses), "pose-03, left camera: the board is too dark");
    poses = good;
    poses[1].left.moved_px = 0.6;
    expect_refused(calibrated(room, poses), "pose-01, left camera: the board or the rig moved by 0.60 px");
    poses = good;
    poses[4].left.decoded_share = 0.05;
    expect_refused(calibrated(room, poses), "pose-04, left camera: only 5 %");
    poses = good;
    poses[5].left.width = 640;
    expect_refused(calibrated(room, poses), "pose-05, left camera: 640 x 576 pixels");
}

/// A telephoto picture of a far board tells next to nothing of the focal length: the numbers are not believed.
TEST(CalibrateRigRefuses, ImplausibleFocalLengths) {
    test::IdealRoom room = test::ideal_room();
    for (CameraModel* camera : {&room.rig.left_camera, &room.rig.right_camera}) {
        camera->focal_x *= 16;
        camera->focal_y *= 16;
        camera->k1 = 0;
        RigidTransform away = RigidTransform::Identity();
        away.translation().z() = 13500;
        camera->device_from_rig = away * camera->device_from_rig;
    }
    room.noise_px = 0.01;
    expect_refused(calibrated(room, room.observe(), false), "focal length comes out as");
}

}  // namespace
}  // namespace planlight
