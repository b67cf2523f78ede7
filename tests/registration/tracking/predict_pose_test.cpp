#include "registration/tracking/predict_pose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "marker_scene.h"

namespace planlight::test {
namespace {

using std::chrono::milliseconds;

constexpr double kFrameS = 1 / 60.0, kLatencyS = 0.045;

TrackedPose measured(const RigidTransform& truth, double t_s, std::mt19937& random) {
    std::normal_distribution<double> noise(0, 0.05);
    Eigen::Matrix<double, 6, 1> twist;
    for (int k = 0; k < 6; ++k) twist[k] = noise(random) / (k < 3 ? 100 : 1);
    TrackedPose pose;
    pose.at = from_seconds(t_s);
    pose.rig_from_patient = Eigen::Translation3d(head_centre()) * transform_from_twist(twist) *
                            Eigen::Translation3d(-head_centre()) * truth;
    return pose;
}

double off_mm(const RigidTransform& a, const RigidTransform& b) {
    double worst = 0;
    for (const auto& s : stickers_on_head())
        worst = std::max(worst, (a * (head_centre() + s.centre) - b * (head_centre() + s.centre)).norm());
    return worst;
}

struct Spread {
    double median, p95, worst;
};
Spread spread(std::vector<double> v) {
    std::sort(v.begin(), v.end());
    return {v[v.size() / 2], v[v.size() * 95 / 100], v.back()};
}

/// Light that is drawn with the pose `kLatencyS` old: as measured, and as predicted.
template <class Motion>
std::pair<Spread, Spread> compare(const Motion& motion, double length_s) {
    std::mt19937 random(4);
    PosePredictor predictor;
    std::vector<double> plain, predicted;
    for (double t = 0; t < length_s; t += kFrameS) {
        const TrackedPose pose = measured(motion(t), t, random);
        predictor.add(pose, head_centre());
        if (t < 0.2) continue;
        const RigidTransform lit = motion(t + kLatencyS);
        plain.push_back(off_mm(*pose.rig_from_patient, lit));
        predicted.push_back(off_mm(*predictor.rig_from_patient_at(from_seconds(t + kLatencyS)), lit));
    }
    return {spread(plain), spread(predicted)};
}

class HeadSpeed : public testing::TestWithParam<double> {};

// A head that sways at a peak speed of 20 to 50 mm/s: the best that constant velocity can do is the acceleration's
// share, a t^2 / 2 = 0.16 mm at 50 mm/s and 3.1 rad/s; the noise is amplified to about twice its size.
TEST_P(HeadSpeed, PredictionIsBetterThanNone) {
    const double speed = GetParam(), omega = 3.1;
    const auto motion = [&](double t) {
        return head_move({2 * std::sin(1.3 * t), 1.5 * std::sin(1.9 * t), 0},
                         {speed / omega * std::sin(omega * t), 0.3 * speed / omega * std::sin(0.7 * omega * t), 0});
    };
    const auto [plain, predicted] = compare(motion, 20);
    std::printf("%.0f mm/s, 45 ms: none median %.2f p95 %.2f worst %.2f mm; predicted %.2f, %.2f, %.2f\n", speed,
                plain.median, plain.p95, plain.worst, predicted.median, predicted.p95, predicted.worst);
    EXPECT_LT(predicted.median, 0.35 * plain.median);
    // Slow heads: the measurement's noise, not the latency, is most of what is left.
    EXPECT_LT(predicted.p95, (speed < 30 ? 0.5 : 0.35) * plain.p95);
    EXPECT_LT(predicted.worst, 1);
}
INSTANTIATE_TEST_SUITE_P(Speeds, HeadSpeed, testing::Values(20., 35., 50.));

// At rest the prediction may amplify the noise of the measurement (0.05 mm and 0.0005 rad per axis), but not beyond
// what a person can see in a line of light.
TEST(PosePredictor, StaysQuietAtRest) {
    const auto [plain, predicted] = compare([](double) { return RigidTransform::Identity(); }, 20);
    std::printf("at rest: none p95 %.2f; predicted p95 %.2f mm\n", plain.p95, predicted.p95);
    EXPECT_LT(predicted.p95, 0.45);
}

// 40 mm/s that end within 50 ms: constant velocity must run on for the latency (40 mm/s x 45 ms = 1.8 mm) at most,
// and be back within 0.3 mm after 0.25 s.
TEST(PosePredictor, RunsOnAfterASuddenStopByNoMoreThanTheLatency) {
    const auto place = [](double t) {
        if (t < 1) return 40 * t;
        if (t < 1.05) return 40 * (t - (t - 1) * (t - 1) / 0.1);
        return 40 * 1.025;
    };
    std::mt19937 random(9);
    PosePredictor predictor;
    double worst = 0, late = 0;
    for (double t = 0; t < 2; t += kFrameS) {
        predictor.add(measured(head_move({0, 0, 0}, {place(t), 0, 0}), t, random), head_centre());
        const double past =
            ((*predictor.rig_from_patient_at(from_seconds(t + kLatencyS))) * head_centre() - head_centre()).x() -
            place(t + kLatencyS);
        if (t > 0.95) worst = std::max(worst, past);
        if (t > 1.3) late = std::max(late, std::abs(past));
    }
    std::printf("stop from 40 mm/s: runs on by %.2f mm at most, %.2f mm after 0.25 s\n", worst, late);
    EXPECT_LT(worst, 1.8);
    EXPECT_LT(late, 0.3);
}

TEST(PosePredictor, PredictsNothingBeforeAMeasurementAndNothingPastItsReach) {
    std::mt19937 random(1);
    PosePredictor predictor;
    EXPECT_FALSE(predictor.rig_from_patient_at({}));
    predictor.add(TrackedPose{}, head_centre());
    EXPECT_FALSE(predictor.rig_from_patient_at({}));
    predictor.add(measured(RigidTransform::Identity(), 1, random), head_centre());
    EXPECT_TRUE(predictor.rig_from_patient_at(milliseconds(1160)));
    EXPECT_FALSE(predictor.rig_from_patient_at(milliseconds(1161)));
    predictor.reset();
    EXPECT_FALSE(predictor.rig_from_patient_at(milliseconds(1000)));
}

// After a gap the old velocity says nothing: the place just measured is all that is known.
TEST(PosePredictor, CarriesNoVelocityAcrossAGap) {
    std::mt19937 random(1);
    PosePredictor predictor;
    for (int k = 0; k < 60; ++k)
        predictor.add(measured(head_move({0, 0, 0}, {0.8 * k, 0, 0}), k * kFrameS, random), head_centre());
    const TrackedPose after = measured(head_move({0, 0, 0}, {48, 0, 0}), 59 * kFrameS + 0.2, random);
    predictor.add(after, head_centre());
    EXPECT_NEAR(off_mm(*predictor.rig_from_patient_at(after.at + milliseconds(100)), *after.rig_from_patient), 0, 1e-9);
}

// A pure turn about the head's middle must not leak into a translation, wherever the patient frame's origin lies.
TEST(PosePredictor, PredictsATurnAboutTheMiddleOfTheHead) {
    std::mt19937 random(1);
    PosePredictor predictor;
    const auto motion = [](double t) { return head_move({0, 12 * t, 0}, {0, 0, 0}); };
    for (int k = 0; k < 90; ++k) predictor.add(measured(motion(k * kFrameS), k * kFrameS, random), head_centre());
    const double at = 89 * kFrameS + 0.1;
    EXPECT_LT(off_mm(*predictor.rig_from_patient_at(from_seconds(at)), motion(at)), 0.6);
}

}  // namespace
}  // namespace planlight::test
