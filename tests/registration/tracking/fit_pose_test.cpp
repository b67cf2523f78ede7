#include "registration/tracking/fit_pose.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "marker_scene.h"
#include "registration/tracking/external_reliability.h"
#include "registration/tracking/largest_error.h"

namespace planlight::test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kNoise_px = 0.03;

double drawn(std::mt19937& random) {
    return std::normal_distribution<double>()(random);
}

Vector3d drawn_vector(std::mt19937& random) {
    const double x = drawn(random), y = drawn(random), z = drawn(random);
    return {x, y, z};
}

/// Markers at known places, measured with noise as the reference; the head moved a little; one of them slipped.
struct Trial {
    std::vector<PatientMarker> markers;
    std::vector<Sighting> sightings;
    RigidTransform truth = RigidTransform::Identity();

    Trial(const std::vector<Vector3d>& places, std::mt19937& random, const Vector3d& slip_of_first = Vector3d::Zero()) {
        const RigCalibration rig = paper_rig();
        const Vector3d middle(0, 0, 900);
        for (const Vector3d& p : places)
            markers.push_back({p + 0.01 * drawn_vector(random).cwiseProduct(Vector3d(1, 1, 3)), 0.02});
        truth = Eigen::Translation3d(middle + 3 * drawn_vector(random)) *
                Eigen::AngleAxisd(0.03, drawn_vector(random).normalized()) * Eigen::Translation3d(-middle);
        for (std::size_t k = 0; k < places.size(); ++k)
            for (const bool left : {true, false}) {
                const Vector3d p = places[k] + (k == 0 ? slip_of_first : Vector3d::Zero());
                MarkerObservation seen;
                const double x = drawn(random), y = drawn(random);
                seen.pixel = seen_at(left ? rig.left_camera : rig.right_camera, truth * p) + kNoise_px * Vector2d(x, y);
                seen.sigma_px = kNoise_px;
                seen.radius_px = 8;
                seen.contrast = 100;
                sightings.push_back({static_cast<int>(k), left, seen});
            }
    }

    CheckedPose checked(const std::vector<Vector3d>& places_in_patient = {},
                        const TrackingSettings& settings = {}) const {
        return fit_pose_checked(paper_rig(), markers, sightings, RigidTransform::Identity(), settings,
                                places_in_patient);
    }
    double off_mm(const CheckedPose& pose, const Vector3d& p) const {
        return (pose.fit->rig_from_patient * p - truth * p).norm();
    }
};

const Vector3d kPlan(0, 90, 930);  ///< 90 mm below the markers and 30 mm deeper

/// `count` markers over `span_mm`, their middle ones `sag_mm` off the line through the ends.
std::vector<Vector3d> line(double span_mm, double sag_mm, int count) {
    std::vector<Vector3d> places;
    for (int i = 0; i < count; ++i) {
        const double t = 2. * i / (count - 1) - 1;
        places.emplace_back(0.5 * span_mm * t, 0, 900 + sag_mm * t * t);
    }
    return places;
}

std::vector<Vector3d> wide_triangle() {
    return {{-40, -30, 905}, {40, -25, 908}, {0, 30, 895}};
}

// The turn about the line moves the plan by millimetres to centimetres while the markers' middle lies still.
TEST(FitPoseChecked, MarkersNearlyInOneLineGiveNoPose) {
    std::mt19937 random(1);
    for (const auto& places : {line(60, 0, 3), line(60, 0.5, 3), line(60, 1, 3), line(90, 0.5, 4)})
        for (int trial = 0; trial < 40; ++trial)
            for (const bool told : {true, false}) {
                const CheckedPose pose =
                    Trial(places, random).checked(told ? std::vector<Vector3d>{kPlan} : std::vector<Vector3d>{});
                ASSERT_FALSE(pose.fit) << places[0].z() << " " << pose.fit->error_mm;
                EXPECT_EQ(pose.reason,
                          "the markers seen lie nearly in one line, about which the pose may turn: uncover another "
                          "beside it, or paste one there and scan again");
            }
}

// 400 frames, of which 95 % lie within: 91 to 98 are three standard deviations of chance; what the calibration may be
// wrong by is part of the bound and not of these frames, so that more may lie within.
TEST(FitPoseChecked, TheStatedBoundHoldsAtThePlan) {
    std::mt19937 random(2);
    TrackingSettings whatever_may_slip;
    whatever_may_slip.max_external_reliability_mm = std::numeric_limits<double>::infinity();
    for (const auto& places : {wide_triangle(), line(60, 6, 3), line(60, 12, 3), line(90, 5, 4)}) {
        int within = 0, within_all_round = 0;
        double at_the_plan_mm = 0, at_the_middle_mm = 0;
        constexpr int kTrials = 400;
        for (int k = 0; k < kTrials; ++k) {
            const Trial trial(places, random);
            const CheckedPose told = trial.checked({kPlan}, whatever_may_slip), untold = trial.checked();
            ASSERT_TRUE(told.fit) << told.reason;
            ASSERT_TRUE(untold.fit) << untold.reason;
            within += trial.off_mm(told, kPlan) <= told.fit->bound_95_mm;
            within_all_round += trial.off_mm(untold, kPlan) <= untold.fit->bound_95_mm;
            const PoseUncertainty& uncertainty = told.fit->uncertainty;
            at_the_plan_mm += told.fit->bound_95_mm / kTrials;
            at_the_middle_mm += predicted_error(uncertainty, uncertainty.middle_in_rig).bound_95_mm / kTrials;
        }
        EXPECT_GE(within, 0.91 * kTrials) << places[0].z();
        EXPECT_GE(within_all_round, 0.91 * kTrials) << places[0].z();
        EXPECT_GT(at_the_plan_mm, 2 * at_the_middle_mm);
        EXPECT_LT(at_the_plan_mm, 2);
    }
}

/// The farthest that `draws` slips of one marker by up to 1 mm move the pose at the plan without sightings that
/// disagree.
double farthest_unnoticed_mm(const Trial& still, double noticed_chi_square, int draws, std::mt19937& random) {
    const RigCalibration rig = paper_rig();
    const auto before = fit_pose(rig, still.markers, still.sightings, still.truth);
    double farthest = 0;
    for (int k = 0; k < draws; ++k) {
        std::vector<Sighting> sightings = still.sightings;
        const int marker = k % static_cast<int>(still.markers.size());
        const Vector3d place = still.truth * still.markers[static_cast<std::size_t>(marker)].centre_in_patient;
        const Vector3d slip =
            std::uniform_real_distribution<double>(0.5, 1)(random) * drawn_vector(random).normalized();
        for (Sighting& s : sightings)
            if (s.marker == marker) {
                const CameraModel& camera = s.left ? rig.left_camera : rig.right_camera;
                s.seen.pixel += seen_at(camera, place + slip) - seen_at(camera, place);
            }
        const auto after = fit_pose(rig, still.markers, sightings, still.truth);
        if (!before || !after || after->chi_square > noticed_chi_square) continue;
        farthest = std::max(farthest, (after->rig_from_patient * kPlan - before->rig_from_patient * kPlan).norm());
    }
    return farthest;
}

// By slips that are tried: none moves the plan farther than is said, and the farthest not much less.
TEST(ExternalReliability, IsHowFarASlipMovesThePlanBeforeItShows) {
    std::mt19937 random(4);
    auto square = wide_triangle();
    square.emplace_back(35, 40, 899);
    for (const auto& places : {wide_triangle(), line(60, 12, 3), square, line(90, 8, 4)}) {
        const Trial trial(places, random);
        const double noticed = 3.5 * (4. * static_cast<double>(places.size()) - 6);
        const double said_mm =
            external_reliability_mm(paper_rig(), trial.markers, trial.sightings, trial.truth, {kPlan}, 1, noticed);
        const double tried_mm = farthest_unnoticed_mm(trial, noticed, 4000, random);
        EXPECT_LT(tried_mm, 1.1 * said_mm) << places.size();  // (to first order)
        EXPECT_GT(tried_mm, 0.5 * said_mm) << places.size();
    }
}

TEST(ExternalReliability, IsInfiniteWhereNothingIsDetermined) {
    std::mt19937 random(5);
    Trial trial(wide_triangle(), random);
    trial.sightings.resize(2);
    EXPECT_TRUE(
        std::isinf(external_reliability_mm(paper_rig(), trial.markers, trial.sightings, trial.truth, {kPlan}, 1, 10)));
}

// The middle marker lies 8 mm beside the line of the others: a millimetre of it is more than ten at the plan.
TEST(FitPoseChecked, WhereASlipWouldNotShowAndMoveThePlanFarThereIsNoPose) {
    std::mt19937 random(6);
    int given = 0;
    for (int k = 0; k < 40; ++k) {
        const CheckedPose pose = Trial(line(80, 8.5, 3), random).checked({kPlan});
        EXPECT_FALSE(pose.fit);
        EXPECT_TRUE(pose.reason.starts_with("so few markers are seen that a slip of one would not show"))
            << pose.reason;
        given += Trial(wide_triangle(), random).checked({kPlan}).fit.has_value();
    }
    EXPECT_EQ(given, 40);
}

// Three in a line and one below: whether the end of the line slipped across it or the lower one moved cannot be told,
// for without the lower one the line may turn, and the plan with it by 10 mm.
TEST(FitPoseChecked, AMarkerIsNotLeftOutByChance) {
    std::mt19937 random(3);
    const std::vector<Vector3d> places{{-40, 0, 900}, {0, 1, 897}, {40, 0, 900}, {0, -40, 903}};
    for (const double slip_mm : {0.3, 0.5, 1.})
        for (int k = 0; k < 60; ++k) {
            const Trial trial(places, random, {0, slip_mm, 0});
            const CheckedPose pose = trial.checked({kPlan});
            if (pose.fit) {
                EXPECT_LT(trial.off_mm(pose, kPlan), 1) << slip_mm;
            } else {
                EXPECT_TRUE(pose.reason.starts_with("a marker has moved, but it cannot be told whether") ||
                            pose.reason.starts_with("the markers seen lie nearly in one line"))
                    << pose.reason;
            }
            if (slip_mm > 0.4) {
                EXPECT_FALSE(pose.fit) << slip_mm;
            }
        }
}

TEST(FitPoseChecked, WhereOneMarkerAloneExplainsItItIsLeftOut) {
    std::mt19937 random(4);
    const std::vector<Vector3d> places{{-40, -30, 905}, {40, -25, 908}, {0, 30, 895}, {10, -5, 894}, {-35, 25, 900}};
    for (const double slip_mm : {0.7, 1., 2.})
        for (int k = 0; k < 40; ++k) {
            const Trial trial(places, random, {0, slip_mm, 0});
            const CheckedPose pose = trial.checked({kPlan});
            ASSERT_TRUE(pose.fit) << slip_mm << ": " << pose.reason;
            ASSERT_EQ(pose.doubts.size(), 1u);
            EXPECT_EQ(pose.doubts[0].marker, 0);
            EXPECT_LT(trial.off_mm(pose, kPlan), 0.5);
        }
}

// Of three none can be left out to see which moved; 0.5 mm of one are 1.3 mm at the plan.
TEST(FitPoseChecked, ThreeMarkersThatDisagreeGiveNoPose) {
    std::mt19937 random(5);
    for (const double slip_mm : {0., 0.5, 0.7, 1.})
        for (int k = 0; k < 60; ++k) {
            const CheckedPose pose = Trial(wide_triangle(), random, {0, slip_mm, 0}).checked({kPlan});
            EXPECT_EQ(pose.fit.has_value(), slip_mm == 0) << slip_mm << ": " << pose.reason;
            if (!pose.fit) {
                EXPECT_EQ(pose.reason,
                          "the 3 markers seen do not agree, and so few cannot tell which of them has moved: uncover "
                          "another, or scan again");
            }
        }
}

PoseUncertainty some_uncertainty(std::mt19937& random) {
    Eigen::Matrix<double, 6, 6> half;
    for (double& value : half.reshaped()) value = drawn(random);
    half.topRows<3>() *= 0.003;
    half.bottomRows<3>() *= 0.1;
    for (int k = 0; k < 6; ++k) half.col(k) *= std::exp(drawn(random));
    return {half * half.transpose(), {10, -20, 900}};
}

// Against 20000 places drawn on the sphere.
TEST(LargestError, AllRoundIsTheLargestOnTheSphere) {
    std::mt19937 random(6);
    for (int trial = 0; trial < 20; ++trial) {
        const PoseUncertainty uncertainty = some_uncertainty(random);
        PredictedError sampled;
        for (int k = 0; k < 20000; ++k) {
            const PredictedError here = predicted_error(
                uncertainty, uncertainty.middle_in_rig + kPlanReach_mm * drawn_vector(random).normalized());
            sampled.rms_mm = std::max(sampled.rms_mm, here.rms_mm);
            sampled.bound_95_mm = std::max(sampled.bound_95_mm, here.bound_95_mm);
        }
        const PredictedError largest = largest_error(uncertainty, RigidTransform::Identity(), {});
        EXPECT_GE(largest.rms_mm, 0.995 * sampled.rms_mm);
        EXPECT_LE(largest.rms_mm, sampled.rms_mm * 1.01);
        EXPECT_GE(largest.bound_95_mm, 0.97 * sampled.bound_95_mm);
    }
}

TEST(LargestError, OfAPlanIsThatOfItsOutermostPlaces) {
    std::mt19937 random(7);
    std::vector<Vector3d> plan;
    for (int k = 0; k < 5000; ++k) plan.push_back(Vector3d(0, 30, 920) + 30 * drawn_vector(random).normalized());
    const auto few = outermost(plan);
    EXPECT_LE(few.size(), 200u);
    for (int trial = 0; trial < 20; ++trial) {
        const PoseUncertainty uncertainty = some_uncertainty(random);
        const double all_mm = largest_error(uncertainty, RigidTransform::Identity(), plan).rms_mm,
                     few_mm = largest_error(uncertainty, RigidTransform::Identity(), few).rms_mm;
        EXPECT_LE(few_mm, all_mm);
        EXPECT_GE(few_mm, 0.99 * all_mm);
    }
    EXPECT_EQ(outermost({{1, 2, 3}}).size(), 1u);
}

}  // namespace
}  // namespace planlight::test
