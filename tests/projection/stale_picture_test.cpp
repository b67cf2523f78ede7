// Poses of every age, good and bad, with a machine that is slow at random places, by a clock that runs fast: no picture
// is ever lit that is stale. As many steps as PLANLIGHT_STEPS says.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <random>

#include "planning_io/types/error.h"
#include "projection/overlay_loop.h"
#include "tests/projection/shapes.h"

namespace planlight {
namespace {

using namespace std::chrono_literals;

/// Every look at it may come later by what a busy machine takes, mostly nothing.
class HurriedClock final : public Clock {
public:
    explicit HurriedClock(std::mt19937& random) : random_(random) {}
    Instant now() const override {
        if (share_(random_) < 0.1) time += std::chrono::milliseconds(std::uniform_int_distribution(1, 120)(random_));
        return time;
    }
    mutable Instant time = 10s;

private:
    std::mt19937& random_;
    mutable std::uniform_real_distribution<double> share_{0, 1};
};

/// What is on the patient at a moment, by the promise of `Projector`; some pictures take long to come, some fail.
class ForgetfulProjector final : public Projector {
public:
    ForgetfulProjector(HurriedClock& clock, std::mt19937& random) : clock_(clock), random_(random) {}
    int width() const override { return 96; }
    int height() const override { return 64; }
    Instant show(const RgbImage&, Instant valid_until) override {
        until_.reset();
        const double share = std::uniform_real_distribution<double>(0, 1)(random_);
        if (share < 0.01) throw DeviceError("projector", "the cable is out", "plug it in");
        ++shown;
        ordered_at = clock_.time;
        clock_.time += share < 0.05 ? 300ms : 3ms;
        until_ = valid_until;
        return clock_.time + 25ms;
    }
    void go_dark() noexcept override { until_.reset(); }
    bool lit_at(Instant moment) const { return until_ && moment < *until_; }
    Instant until() const { return until_.value_or(Instant{}); }

    long shown = 0;
    Instant ordered_at{};

private:
    HurriedClock& clock_;
    std::mt19937& random_;
    std::optional<Instant> until_{};
};

struct DrawnPose {
    TrackedPose pose;
    bool may_be_lit = true;  ///< as it was drawn from the lot; its age alone is judged apart
};

DrawnPose drawn_pose(Instant now, std::mt19937& random) {
    std::uniform_real_distribution<double> share(0, 1);
    DrawnPose drawn;
    TrackedPose& pose = drawn.pose;
    pose.rig_from_patient = RigidTransform(Eigen::Translation3d(share(random), share(random), share(random)));
    pose.at =
        now - std::chrono::milliseconds(std::uniform_int_distribution(share(random) < 0.9 ? 0 : -300, 110)(random));
    pose.predicted_error_mm = 0.1;
    const double kind = share(random);
    drawn.may_be_lit = kind >= 0.25;
    if (kind < 0.05)
        pose.rig_from_patient.reset();
    else if (kind < 0.1)
        pose.predicted_error_mm = 1.001 + share(random);
    else if (kind < 0.15)
        pose.predicted_error_mm = std::nan("");
    else if (kind < 0.2)
        pose.rig_from_patient->matrix()(1, 1) = std::nan("");
    else if (kind < 0.25)
        pose.rig_from_patient->matrix()(2, 2) = -1;  // a mirror
    return drawn;
}

long steps() {
    const char* wanted = std::getenv("PLANLIGHT_STEPS");
    return wanted ? std::atol(wanted) : 20000;
}

TEST(StalePicture, IsNeverLit) {
    constexpr Instant kMost = 75ms;
    std::mt19937 random(1);
    const SkinSurface skin(test::ball_mesh(80, 3));
    Plan plan;
    plan.boreholes.push_back({"", {0, 0, -80}, {}, 12, 0, {}});
    DrawingSettings drawing_settings;
    drawing_settings.labels = false;
    const PlanDrawing drawing = draw_plan(plan, skin, drawing_settings);
    CameraModel model = test::projector_looking_at({0, 0, 700}, {0, 0, -1}, 700, {0, -1, 0});
    model.width = 96;
    model.height = 64;
    for (double* part : {&model.focal_x, &model.focal_y, &model.centre_x, &model.centre_y}) *part /= 20;
    const DrawingRenderer renderer(skin, model);
    RegistrationResult registration;
    registration.verdict = Verdict::yes;
    registration.patient_from_ct = RigidTransform(Eigen::Translation3d(0, 0, 700));

    HurriedClock clock(random);
    ForgetfulProjector projector(clock, random);
    OverlayLoop loop(projector, clock, renderer, drawing, registration);
    long looks = 0, lit = 0, expired = 0;
    for (long i = 0; i < steps(); ++i) {
        const DrawnPose drawn = drawn_pose(clock.time, random);
        const long shown = projector.shown;
        try {
            const OverlayStep step = loop.step(drawn.pose);
            ASSERT_EQ(step.lit, projector.shown > shown);
        } catch (const DeviceError&) {
            ASSERT_FALSE(projector.lit_at(clock.time)) << "step " << i << ": lit after a fault";
        }
        const bool new_light = projector.shown > shown;
        if (!new_light) {
            ASSERT_FALSE(projector.lit_at(clock.time)) << "step " << i << ": the light of the pose before it stays";
        } else {
            ASSERT_TRUE(drawn.may_be_lit) << "step " << i;
            ASSERT_LE(projector.ordered_at - drawn.pose.at, kMost) << "step " << i << ": drawn by an old pose";
        }
        const Instant until = clock.time + std::chrono::milliseconds(std::uniform_int_distribution(1, 200)(random));
        for (; clock.time < until; clock.time += 7ms) {
            ++looks;
            if (!projector.lit_at(clock.time)) {
                expired += new_light ? 1 : 0;
                continue;
            }
            ++lit;
            ASSERT_LE(clock.time - projector.ordered_at, kMost) << "step " << i;
            ASSERT_LE(clock.time - drawn.pose.at, 2 * kMost) << "step " << i << ": drawn by an old pose";
        }
    }
    std::printf("%ld pictures in %ld steps; %ld looks at light, %ld after it had expired\n", projector.shown, steps(),
                lit, expired);
    EXPECT_GT(projector.shown, steps() / 5);
    EXPECT_GT(lit, steps() / 5);
    EXPECT_GT(expired, steps() / 5);
    EXPECT_GT(looks, lit);
}

}  // namespace
}  // namespace planlight
