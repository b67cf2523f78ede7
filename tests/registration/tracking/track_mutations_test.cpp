#include <gtest/gtest.h>

#include "marker_scene.h"
#include "registration/tracking/track_patient.h"

namespace planlight::test {
namespace {

// What a wrong calibration does to the tracking: the true rig makes the pictures, a mutant of it is tracked with.
struct Outcome {
    std::size_t reference_markers = 0;
    bool pose = false;
    double residual_px = 0;
    std::string reason;
};

Outcome track_with(const RigCalibration& mutant, const RigCalibration& truth) {
    std::mt19937 random(2);
    const RigidTransform rig_from_head{Eigen::Translation3d(head_centre())};
    PatientTracker tracker(mutant);
    Outcome outcome;
    // Reference with the head at the edge of the view, then turned and moved across it: the lens' distortion differs.
    const RigidTransform first = head_move({0, 0, 0}, {-50, -35, 0}), then = head_move({6, -12, 25}, {55, 40, 30});
    outcome.reference_markers =
        tracker.set_reference(render_frame(truth, moved(first * rig_from_head, stickers_on_head()), {}, {}, random))
            .size();
    const TrackedPose pose = tracker.update(render_frame(truth, moved(then * rig_from_head, stickers_on_head()), {},
                                                         std::chrono::milliseconds(20), random));
    outcome.pose = pose.rig_from_patient.has_value();
    outcome.residual_px = pose.residual_px;
    outcome.reason = pose.reason;
    std::printf("reference %zu, pose %d, residual %.2f px, %s\n", outcome.reference_markers, outcome.pose,
                outcome.residual_px, outcome.reason.c_str());
    return outcome;
}

TEST(TrackingMutations, TheTrueRigTracks) {
    const Outcome outcome = track_with(paper_rig(), paper_rig());
    EXPECT_EQ(outcome.reference_markers, 6u);
    EXPECT_TRUE(outcome.pose);
    EXPECT_LT(outcome.residual_px, 0.15);
}

TEST(TrackingMutations, ExchangedCamerasGiveNoReference) {
    RigCalibration mutant = paper_rig();
    std::swap(mutant.left_camera, mutant.right_camera);
    const Outcome outcome = track_with(mutant, paper_rig());
    EXPECT_LT(outcome.reference_markers, 3u);
    EXPECT_FALSE(outcome.pose);
}

TEST(TrackingMutations, AFlippedDistortionSignIsRefused) {
    RigCalibration mutant = paper_rig();
    for (CameraModel* camera : {&mutant.left_camera, &mutant.right_camera}) camera->k1 *= -1, camera->k2 *= -1;
    EXPECT_FALSE(track_with(mutant, paper_rig()).pose);
}

TEST(TrackingMutations, ATransposedCameraRotationIsRefused) {
    RigCalibration mutant = paper_rig();
    mutant.right_camera.device_from_rig.linear() = mutant.right_camera.device_from_rig.linear().transpose().eval();
    EXPECT_FALSE(track_with(mutant, paper_rig()).pose);
}

TEST(TrackingMutations, ACameraKnockedByHalfADegreeIsRefused) {
    RigCalibration mutant = paper_rig();
    mutant.right_camera.device_from_rig =
        Eigen::AngleAxisd(0.0087, Eigen::Vector3d::UnitX()) * mutant.right_camera.device_from_rig;
    EXPECT_FALSE(track_with(mutant, paper_rig()).pose);
}

}  // namespace
}  // namespace planlight::test
