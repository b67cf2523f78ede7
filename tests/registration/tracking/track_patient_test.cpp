#include "registration/tracking/track_patient.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numbers>

#include "marker_scene.h"
#include "planning_io/types/error.h"
#include "registration/tracking/largest_error.h"

namespace planlight::test {
namespace {

using std::chrono::milliseconds;

RigidTransform rig_from_head() {
    return RigidTransform(Eigen::Translation3d(head_centre()));
}

std::vector<Sticker> stickers_in_rig(const RigidTransform& rig_from_patient = RigidTransform::Identity()) {
    return moved(rig_from_patient * rig_from_head(), stickers_on_head());
}

/// How far the worst of the places the plan is drawn at (the skin under the stickers) is put wrong.
double error_mm(const RigidTransform& measured, const RigidTransform& truth) {
    double worst = 0;
    for (const auto& s : stickers_in_rig()) worst = std::max(worst, (measured * s.centre - truth * s.centre).norm());
    return worst;
}

/// A tracker with its reference, the markers numbered as the stickers are.
struct Tracked {
    RigCalibration rig;
    std::mt19937 random{7};
    PatientTracker tracker;
    Look look;
    int time_ms = 0;

    explicit Tracked(const RigCalibration& r, const Look& l = {}) : rig(r), tracker(r), look(l) {
        tracker.set_reference(render_frame(rig, stickers_in_rig(), look, {}, random));
    }
    TrackedPose see(const std::vector<Sticker>& stickers, int step_ms = 17) {
        time_ms += step_ms;
        return tracker.update(render_frame(rig, stickers, look, milliseconds(time_ms), random));
    }
    int marker_of(std::size_t sticker) const {
        const auto& m = tracker.markers();
        const Eigen::Vector3d p = stickers_in_rig()[sticker].centre;
        for (std::size_t k = 0; k < m.size(); ++k)
            if ((m[k].centre_in_patient - p).norm() < 3) return static_cast<int>(k);
        return -1;
    }
};

RigidTransform swaying(double t_s) {
    return head_move({4 * std::sin(3 * t_s), 3 * std::sin(2 * t_s), 2 * std::sin(4 * t_s)},
                     {12 * std::sin(2.5 * t_s), 8 * std::sin(3.1 * t_s), 6 * std::sin(1.7 * t_s)});
}

class BothOptics : public testing::TestWithParam<bool> {
protected:
    RigCalibration rig() const { return GetParam() ? modern_rig() : paper_rig(); }
};
INSTANTIATE_TEST_SUITE_P(Rigs, BothOptics, testing::Bool(), [](const auto& i) { return i.param ? "modern" : "paper"; });

// 0.3 mm: what the paper's optics give one marker in depth, at one sigma of 0.05 px, is 0.08 mm.
TEST_P(BothOptics, ReferenceHoldsEveryMarkerWhereItIs) {
    const Tracked t(rig());
    ASSERT_EQ(t.tracker.markers().size(), 6u);
    for (const auto& s : stickers_in_rig()) {
        double nearest = 1e9;
        for (const auto& m : t.tracker.markers()) nearest = std::min(nearest, (m.centre_in_patient - s.centre).norm());
        EXPECT_LT(nearest, 0.3);
    }
}

// The bounds are the design's: accuracy to 0.1 mm at the skin under the markers (median), 0.25 mm for the paper's
// coarse pixels.
TEST_P(BothOptics, FollowsASwayingHead) {
    Tracked t(rig());
    std::vector<double> errors, ratio;
    for (int k = 1; k <= 20; ++k) {
        const RigidTransform truth = swaying(k * 0.017);
        const TrackedPose pose = t.see(stickers_in_rig(truth));
        ASSERT_TRUE(pose.rig_from_patient) << k << ": " << pose.reason;
        EXPECT_EQ(pose.markers_left + pose.markers_right, 12);
        errors.push_back(error_mm(*pose.rig_from_patient, truth));
        const Eigen::Vector3d middle = rig_from_head() * Eigen::Vector3d(0, -8, -70);
        ratio.push_back((*pose.rig_from_patient * middle - truth * middle).norm() / pose.predicted_error_mm);
    }
    std::sort(errors.begin(), errors.end());
    std::sort(ratio.begin(), ratio.end());
    std::printf("worst marker: median %.3f mm, p95 %.3f mm; error / predicted: median %.2f\n", errors[10], errors[18],
                ratio[10]);
    EXPECT_LT(errors[10], GetParam() ? 0.06 : 0.12);
    EXPECT_LT(errors[18], GetParam() ? 0.1 : 0.25);
    // The prediction allows for a calibration error of 0.07 px, which this rig does not have: it is cautious here, not
    // wrong.
    EXPECT_GT(ratio[10], 0.02);
    EXPECT_LT(ratio[10], 1.6);
}

TEST_P(BothOptics, SurvivesCoveredMarkersAndStopsAtTwo) {
    Tracked t(rig());
    auto stickers = stickers_in_rig();
    for (std::size_t covered = 0; covered < 3; ++covered) {
        stickers[covered].covered = true;
        const TrackedPose pose = t.see(stickers);
        ASSERT_TRUE(pose.rig_from_patient) << pose.reason;
        EXPECT_EQ(pose.markers_left, 5 - static_cast<int>(covered));
        EXPECT_LT(error_mm(*pose.rig_from_patient, RigidTransform::Identity()), 0.8);
    }
    stickers[3].covered = true;
    const TrackedPose none = t.see(stickers);
    EXPECT_FALSE(none.rig_from_patient);
    EXPECT_EQ(none.reason, "only 2 of 6 markers seen; 3 are needed");
    const TrackedPose again = t.see(stickers_in_rig());
    ASSERT_TRUE(again.rig_from_patient) << again.reason;
    EXPECT_EQ(again.markers_left, 6);
    EXPECT_LT(error_mm(*again.rig_from_patient, RigidTransform::Identity()), 0.3);
}

TEST(PatientTracker, CountsAMarkerThatOneCameraSees) {
    Tracked t(paper_rig());
    auto in_left = stickers_in_rig(), in_right = stickers_in_rig();
    in_left[0].covered = in_left[1].covered = true;
    in_right[2].covered = in_right[3].covered = true;
    std::mt19937 random(3);
    StereoFrame frame;
    frame.left = render(t.rig.left_camera, in_left, {}, random);
    frame.right = render(t.rig.right_camera, in_right, {}, random);
    frame.at = milliseconds(17);
    const TrackedPose pose = t.tracker.update(frame);
    ASSERT_TRUE(pose.rig_from_patient) << pose.reason;
    EXPECT_EQ(pose.markers_left, 4);
    EXPECT_EQ(pose.markers_right, 4);
    EXPECT_LT(error_mm(*pose.rig_from_patient, RigidTransform::Identity()), 0.4);
}

TEST_P(BothOptics, FindsTheHeadAgainAfterAJump) {
    Tracked t(rig());
    const RigidTransform jump = head_move({8, 16, -9}, {GetParam() ? 25. : 50., -20, 26});
    const TrackedPose pose = t.see(stickers_in_rig(jump));
    ASSERT_TRUE(pose.rig_from_patient) << pose.reason;
    EXPECT_LT(error_mm(*pose.rig_from_patient, jump), 0.4);
    const TrackedPose next = t.see(stickers_in_rig(jump));
    ASSERT_TRUE(next.rig_from_patient) << next.reason;
}

// Along one camera's line of sight its markers stay where they were, and the other camera's go out of its windows: a
// pose from the one alone would do, and be a millimetre off in depth.
TEST_P(BothOptics, AfterAJumpAlongOneSightTheOtherCameraIsSearchedToo) {
    for (const bool left : {true, false})
        for (const double jump_mm : {-60., -40., 45., 70.}) {
            Tracked t(rig());
            const CameraModel& camera = left ? t.rig.left_camera : t.rig.right_camera;
            const Eigen::Vector3d sight = (head_centre() - camera.centre_in_rig()).normalized();
            RigidTransform jump = RigidTransform::Identity();
            jump.translation() = jump_mm * sight;
            const TrackedPose pose = t.see(stickers_in_rig(jump));
            ASSERT_TRUE(pose.rig_from_patient) << pose.reason;
            EXPECT_GE(pose.markers_left, 5) << jump_mm;
            EXPECT_GE(pose.markers_right, 5) << jump_mm;
            EXPECT_LT(error_mm(*pose.rig_from_patient, jump), 0.4) << jump_mm;
        }
}

TEST(PatientTracker, APoseFromOneCameraSaysHowWeakItIs) {
    Tracked t(paper_rig());
    int within = 0;
    constexpr int kFrames = 12;
    double both_mm = 0;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const auto& m : t.tracker.markers()) middle += m.centre_in_patient / 6.;
    t.tracker.set_places({middle});
    for (int k = 0; k < kFrames; ++k) {
        const RigidTransform truth = swaying(0.1 * k);
        std::mt19937 random(static_cast<unsigned>(k));
        StereoFrame frame = render_frame(t.rig, stickers_in_rig(truth), {}, milliseconds(17 * (k + 1)), random);
        const TrackedPose by_both = t.tracker.update(frame);
        ASSERT_TRUE(by_both.rig_from_patient);
        both_mm += by_both.bound_95_mm / kFrames;
        std::fill(frame.right.pixels.begin(), frame.right.pixels.end(), std::uint8_t{12});
        frame.at += milliseconds(3);
        const TrackedPose pose = t.tracker.update(frame);
        ASSERT_TRUE(pose.rig_from_patient) << pose.reason;
        EXPECT_EQ(pose.markers_right, 0);
        EXPECT_GT(pose.bound_95_mm, 3 * by_both.bound_95_mm);
        within += (*pose.rig_from_patient * middle - truth * middle).norm() < pose.bound_95_mm;
    }
    EXPECT_GE(within, kFrames - 2);
    EXPECT_LT(both_mm, 0.1);
}

TEST(PatientTracker, FindsTheHeadAfterALongLossAnywhereInView) {
    Tracked t(paper_rig());
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(-1, 1);
    int found = 0;
    for (int trial = 0; trial < 8; ++trial) {
        EXPECT_FALSE(t.see({}).rig_from_patient);
        const RigidTransform there = head_move({12 * uniform(random), 18 * uniform(random), 60 * uniform(random)},
                                               {60 * uniform(random), 30 * uniform(random), 40 * uniform(random)});
        const TrackedPose pose = t.see(stickers_in_rig(there));
        if (!pose.rig_from_patient) {
            std::printf("trial %d: %s\n", trial, pose.reason.c_str());
            continue;
        }
        ++found;
        EXPECT_LT(error_mm(*pose.rig_from_patient, there), 0.5) << trial;
    }
    EXPECT_GE(found, 7);
}

TEST(PatientTracker, StartsFromMarkersOfAFile) {
    PatientTracker tracker(paper_rig());
    std::vector<PatientMarker> markers;
    for (const auto& s : stickers_on_head()) markers.push_back({s.centre, 0.02});
    tracker.set_reference(markers);
    std::mt19937 random(5);
    const TrackedPose pose = tracker.update(render_frame(paper_rig(), stickers_in_rig(), {}, milliseconds(5), random));
    ASSERT_TRUE(pose.rig_from_patient) << pose.reason;
    EXPECT_LT((pose.rig_from_patient->translation() - head_centre()).norm(), 0.4);
}

// A mirrored arrangement has all the distances of the true one; only a reflection would map it, never a rigid motion.
TEST(PatientTracker, RefusesAMirroredOrExchangedArrangement) {
    Tracked t(paper_rig());
    EXPECT_FALSE(t.see({}).rig_from_patient);
    auto mirrored = stickers_on_head();
    for (Sticker& s : mirrored) s.centre.x() *= -1, s.normal.x() *= -1;
    const TrackedPose pose = t.see(moved(rig_from_head(), mirrored));
    EXPECT_FALSE(pose.rig_from_patient) << pose.residual_px;
    EXPECT_FALSE(pose.reason.empty());

    std::vector<PatientMarker> exchanged = t.tracker.markers();
    std::swap(exchanged[0], exchanged[3]);  // the same set: numbering is free after a file
    t.tracker.set_reference(exchanged);
    EXPECT_TRUE(t.see(stickers_in_rig()).rig_from_patient);
}

TEST_P(BothOptics, TellsWhichMarkerSlipped) {
    for (std::size_t slipped = 0; slipped < 6; slipped += GetParam() ? 3 : 1) {
        Tracked t(rig());
        auto stickers = stickers_in_rig();
        const Eigen::Vector3d along = stickers[slipped].normal.cross(Eigen::Vector3d(0.3, 1, 0.2)).normalized();
        stickers[slipped].centre += 1.5 * along;
        const TrackedPose pose = t.see(stickers);
        ASSERT_TRUE(pose.rig_from_patient) << pose.reason;
        ASSERT_EQ(t.tracker.doubts().size(), 1u) << slipped;
        EXPECT_EQ(t.tracker.doubts()[0].marker, t.marker_of(slipped));
        EXPECT_NEAR(t.tracker.doubts()[0].deviation_mm, 1.5, 0.6);  // seen across the line of sight
        EXPECT_LT(error_mm(*pose.rig_from_patient, RigidTransform::Identity()), 0.5);
    }
}

// Three markers cannot tell which of them moved, but they tell that one did.
TEST(PatientTracker, GivesNoPoseWhenOneOfThreeMarkersSlipped) {
    Tracked t(paper_rig());
    auto stickers = stickers_in_rig();
    for (const std::size_t k : {1u, 3u, 4u}) stickers[k].covered = true;
    ASSERT_TRUE(t.see(stickers).rig_from_patient);
    stickers[0].centre += Eigen::Vector3d(3, 1, 0);
    const TrackedPose pose = t.see(stickers);
    EXPECT_FALSE(pose.rig_from_patient);
    EXPECT_FALSE(pose.reason.empty());
}

// A hand then covers half of the markers: among three the slipped one would pass, or spoil the pose.
TEST(PatientTracker, AMarkerThatSlippedIsNotTrustedWhenFewAreLeft) {
    Tracked t(paper_rig());
    auto stickers = stickers_in_rig();
    const Eigen::Vector3d home = stickers[0].centre;
    stickers[0].centre += 0.5 * stickers[0].normal.unitOrthogonal();
    for (int k = 0; k < 6; ++k) ASSERT_TRUE(t.see(stickers).rig_from_patient);
    ASSERT_EQ(t.tracker.doubts().size(), 1u);
    EXPECT_EQ(t.tracker.doubts()[0].marker, t.marker_of(0));
    auto few = stickers;
    for (const std::size_t k : {1u, 3u, 4u}) few[k].covered = true;
    const TrackedPose pose = t.see(few);
    EXPECT_FALSE(pose.rig_from_patient);
    EXPECT_EQ(pose.reason, "only 2 of 6 markers seen in their place; 3 are needed");
    few[1].covered = false;
    ASSERT_TRUE(t.see(few).rig_from_patient) << "three others";
    EXPECT_EQ(t.tracker.doubts().size(), 1u);

    stickers[0].centre = home;
    for (int k = 0; k < 6; ++k) ASSERT_TRUE(t.see(stickers).rig_from_patient);
    EXPECT_TRUE(t.tracker.doubts().empty()) << "it was put back, and the others say so";
    few = stickers;
    for (const std::size_t k : {1u, 3u, 4u}) few[k].covered = true;
    EXPECT_TRUE(t.see(few).rig_from_patient);
}

// What covers a part of a disc for a moment is no slip.
TEST(PatientTracker, AMarkerDoubtedForAMomentIsUsedAgainAtOnce) {
    Tracked t(paper_rig());
    auto stickers = stickers_in_rig();
    stickers[0].centre += stickers[0].normal.unitOrthogonal();
    for (int k = 0; k < 3; ++k) ASSERT_TRUE(t.see(stickers).rig_from_patient);
    const TrackedPose pose = t.see(stickers_in_rig());
    EXPECT_EQ(pose.markers_left, 6);
    EXPECT_TRUE(t.tracker.doubts().empty());
}

// At the markers' middle a pose is surest, at a plan far from them the turn counts; a new reference is another frame.
TEST(PatientTracker, StatesItsErrorWhereThePlanIs) {
    Tracked t(paper_rig());
    const TrackedPose all_round = t.see(stickers_in_rig());
    ASSERT_TRUE(t.tracker.uncertainty());
    const PoseUncertainty uncertainty = *t.tracker.uncertainty();
    const Eigen::Vector3d middle = uncertainty.middle_in_rig, far = middle + Eigen::Vector3d(0, 60, 40);
    t.tracker.set_places({middle});
    const TrackedPose at_middle = t.see(stickers_in_rig());
    t.tracker.set_places({middle, far});
    const TrackedPose at_plan = t.see(stickers_in_rig());
    EXPECT_NEAR(at_middle.bound_95_mm, predicted_error(uncertainty, middle).bound_95_mm, 0.01);
    EXPECT_NEAR(at_plan.bound_95_mm, predicted_error(uncertainty, far).bound_95_mm, 0.01);
    EXPECT_LT(1.5 * at_middle.bound_95_mm, at_plan.bound_95_mm);
    EXPECT_LT(at_plan.bound_95_mm, all_round.bound_95_mm);
    t.tracker.set_reference(render_frame(t.rig, stickers_in_rig(), {}, milliseconds(500), t.random));
    EXPECT_FALSE(t.tracker.uncertainty());
    EXPECT_NEAR(t.see(stickers_in_rig(), 600).bound_95_mm, all_round.bound_95_mm, 0.03);
}

TEST(PatientTracker, GivesNoPoseWhileTheMarkersInViewLieInOneLine) {
    Tracked t(paper_rig());
    std::vector<Sticker> stickers;
    for (const double x : {-40., 0., 32.}) stickers.push_back({{x, 0.6 * (x == 0), -75}, {0, 0, -1}});
    stickers.push_back({{5, 40, -70}, {0, 0, -1}});
    const RigidTransform rig_from_stickers = rig_from_head();
    stickers = moved(rig_from_stickers, stickers);
    ASSERT_EQ(t.tracker.set_reference(render_frame(t.rig, stickers, {}, {}, t.random)).size(), 4u);
    EXPECT_TRUE(t.see(stickers).rig_from_patient);
    stickers[3].covered = true;
    const TrackedPose pose = t.see(stickers);
    EXPECT_FALSE(pose.rig_from_patient);
    EXPECT_TRUE(pose.reason.starts_with("the markers seen lie nearly in one line")) << pose.reason;
}

TEST(PatientTracker, WithoutMarkersHasNoReferenceAndSaysSo) {
    PatientTracker tracker(paper_rig());
    const StereoFrame dark{GrayImage(744, 576, 10), GrayImage(744, 576, 10), {}, {}, 0};
    EXPECT_TRUE(tracker.set_reference(dark).empty());
    const TrackedPose pose = tracker.update(dark);
    EXPECT_FALSE(pose.rig_from_patient);
    EXPECT_EQ(pose.reason, "the reference has 0 markers; 3 are needed");
    EXPECT_THROW(tracker.update({GrayImage(640, 480), GrayImage(640, 480), {}, {}, 0}), InputError);
}

TEST_P(BothOptics, TimeOfAFrame) {
    Tracked t(rig());
    const StereoFrame frame = render_frame(t.rig, stickers_in_rig(), {}, milliseconds(17), t.random);
    const StereoFrame nothing{GrayImage(frame.left.width, frame.left.height, 90),
                              GrayImage(frame.left.width, frame.left.height, 90),
                              milliseconds(18),
                              {},
                              0};
    std::vector<double> followed, searched;
    const auto timed = [&](const StereoFrame& f, std::vector<double>& ms) {
        const std::clock_t start = std::clock();
        const bool there = t.tracker.update(f).rig_from_patient.has_value();
        ms.push_back(1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
        return there;
    };
    for (int k = 0; k < 30; ++k) {
        EXPECT_TRUE(timed(frame, followed));
    }
    for (int k = 0; k < 8; ++k) {
        t.tracker.update(nothing);
        EXPECT_TRUE(timed(frame, searched));
    }
    std::sort(followed.begin(), followed.end());
    std::sort(searched.begin(), searched.end());
    std::printf("followed: median %.2f ms CPU; searched whole and found: median %.1f ms CPU\n", followed[15],
                searched[4]);
}

}  // namespace
}  // namespace planlight::test
