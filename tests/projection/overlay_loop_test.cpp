#include "projection/overlay_loop.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "planning_io/types/error.h"
#include "tests/projection/shapes.h"

namespace planlight {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;

struct HandClock final : Clock {
    Instant time = 10s;
    Instant now() const override { return time; }
};

struct PaperProjector final : Projector {
    explicit PaperProjector(const Clock& c) : clock(c) {}
    int width() const override { return 1920; }
    int height() const override { return 1080; }
    Instant show(const RgbImage& picture, Instant valid_until) override {
        if (broken) throw DeviceError("projector", "the cable is out", "plug it in");
        lit = true;
        last = picture;
        until = valid_until;
        return clock.now() + delay;
    }
    void go_dark() noexcept override { lit = false; }
    const Clock& clock;
    bool lit = true, broken = false;
    Instant delay = 25ms;  // from show to light
    RgbImage last;
    Instant until{};
};

class OverlayTest : public testing::Test {
protected:
    OverlayTest() {
        Plan plan;
        plan.boreholes.push_back({"", {0, 0, -80}, {}, 12, 0, {}});
        DrawingSettings settings;
        settings.labels = false;
        drawing = draw_plan(plan, skin, settings);
        registration.verdict = Verdict::yes;
        registration.patient_from_ct = RigidTransform(Eigen::Translation3d(0, 0, 700));
    }
    TrackedPose pose(Instant age = 20ms) const {
        TrackedPose p;
        p.rig_from_patient = RigidTransform::Identity();
        p.at = clock.time - age;
        p.predicted_error_mm = 0.1;
        return p;
    }
    OverlayStep step(const TrackedPose& p, const OverlaySettings& settings = {}) {
        OverlayLoop loop(projector, clock, renderer, drawing, registration, settings);
        projector.lit = true;  // whatever was shown before
        OverlayStep result = loop.step(p);
        EXPECT_EQ(result.lit, projector.lit);
        EXPECT_EQ(result.lit, result.reason.empty()) << result.reason;
        EXPECT_EQ(result.picture.width, 1920);
        bool black = true;
        for (const Rgb& c : result.picture.pixels) black = black && c == Rgb{0, 0, 0};
        EXPECT_EQ(black, !result.lit);
        return result;
    }

    SkinSurface skin{test::ball_mesh(80, 4)};
    CameraModel model = test::projector_looking_at({0, 0, 700}, {0, 0, -1}, 700, {0, -1, 0});
    DrawingRenderer renderer{skin, model};
    PlanDrawing drawing;
    RegistrationResult registration;
    HandClock clock;
    PaperProjector projector{clock};
};

TEST_F(OverlayTest, AFreshGoodPoseIsLitAndExpires) {
    OverlaySettings settings;
    settings.predict = false;
    const OverlayStep s = step(pose(), settings);
    EXPECT_TRUE(s.lit);
    EXPECT_EQ(projector.until, clock.time + 75ms);
    EXPECT_GT(s.counts.lit, 50u);
    EXPECT_LT((s.rig_from_ct.translation() - Vector3d(0, 0, 700)).norm(), 1e-12);
}

// Where the next picture comes soon, the last one goes so early that its darkness is seen in time.
TEST_F(OverlayTest, APictureGivesWayToDarknessInTimeWherePicturesComeOften) {
    for (const Instant period : {33ms, 40ms, 66ms}) {
        OverlayLoop loop(projector, clock, renderer, drawing, registration);
        for (int i = 0; i < 20; ++i) {
            clock.time += period;
            ASSERT_TRUE(loop.step(pose()).lit);
        }
        EXPECT_EQ(projector.until, clock.time + (period > 50ms ? 75ms : 65ms));
    }
}

TEST_F(OverlayTest, DarkWithoutARegistration) {
    registration.verdict = Verdict::no;
    registration.reasons = {"only 40 % of the points lie on the skin"};
    EXPECT_NE(step(pose()).reason.find("only 40 %"), std::string::npos);
}

TEST_F(OverlayTest, ADoubtfulRegistrationWaitsForAPerson) {
    registration.verdict = Verdict::ask;
    EXPECT_FALSE(step(pose()).lit);
    OverlaySettings settings;
    settings.operator_confirmed = true;
    EXPECT_TRUE(step(pose(), settings).lit);
}

TEST_F(OverlayTest, DarkWithoutAPoseAndSaysWhy) {
    TrackedPose lost = pose();
    lost.rig_from_patient.reset();
    lost.reason = "2 of 5 markers seen";
    EXPECT_NE(step(lost).reason.find("2 of 5 markers seen"), std::string::npos);
}

TEST_F(OverlayTest, DarkWhenThePoseIsOldUncertainBrokenOrFromTheFuture) {
    EXPECT_TRUE(step(pose(74ms)).lit);
    EXPECT_FALSE(step(pose(76ms)).lit);
    EXPECT_FALSE(step(pose(-500ms)).lit);
    TrackedPose p = pose();
    p.predicted_error_mm = 1.1;
    EXPECT_FALSE(step(p).lit);
    p.predicted_error_mm = std::nan("");
    EXPECT_FALSE(step(p).lit);
    p = pose();
    p.rig_from_patient->matrix()(0, 0) = std::nan("");
    EXPECT_FALSE(step(p).lit);
    p = pose();
    p.rig_from_patient->matrix()(0, 0) = -1;  // a mirror
    EXPECT_FALSE(step(p).lit);
}

TEST_F(OverlayTest, DarkWhenThePlanIsOutOfTheLight) {
    TrackedPose p = pose();
    p.rig_from_patient->translation().x() = 2000;
    const OverlayStep s = step(p);
    EXPECT_FALSE(s.lit);
}

TEST_F(OverlayTest, AFailingProjectorIsDarkenedBeforeTheErrorLeaves) {
    OverlayLoop loop(projector, clock, renderer, drawing, registration);
    projector.lit = projector.broken = true;
    EXPECT_THROW(loop.step(pose()), DeviceError);
    EXPECT_FALSE(projector.lit);
}

TEST_F(OverlayTest, TheEndOfTheLoopIsDark) {
    {
        OverlayLoop loop(projector, clock, renderer, drawing, registration);
        loop.step(pose());
        EXPECT_TRUE(projector.lit);
    }
    EXPECT_FALSE(projector.lit);
}

TEST_F(OverlayTest, IsAsBrightAsItIsSaid) {
    OverlayLoop loop(projector, clock, renderer, drawing, registration, {});
    const auto brightest = [&] {
        int most = 0;
        for (const Rgb& c : loop.step(pose()).picture.pixels) most = std::max<int>(most, c[1]);
        return most;
    };
    const int all = brightest();
    loop.set_brightness(0.5);
    EXPECT_NEAR(brightest(), all * std::pow(0.5, 1 / 2.2), 1.5) << "half of the light, by a projector's gamma of 2.2";
    loop.set_brightness(1);
    EXPECT_EQ(brightest(), all);
}

// T_global = T_cur T_ini, and not the other way round: a patient that lies turned and is then turned again about
// another axis.
TEST_F(OverlayTest, DrawsForTheInitialPoseFirstAndTheMovementAfterIt) {
    const Eigen::AngleAxisd lies(0.4, Vector3d::UnitZ()), turns(0.1, Vector3d::UnitX());
    registration.patient_from_ct = Eigen::Translation3d(0, 0, 700) * RigidTransform(lies);
    TrackedPose p = pose();
    p.rig_from_patient = Eigen::Translation3d(5, 0, 0) * RigidTransform(turns);
    const Vector3d p_in_ct(10, 20, -70);
    const Vector3d p_in_patient = lies * p_in_ct + Vector3d(0, 0, 700);
    const Vector3d p_in_rig = turns * p_in_patient + Vector3d(5, 0, 0);
    OverlaySettings settings;
    settings.predict = false;
    EXPECT_LT((step(p, settings).rig_from_ct * p_in_ct - p_in_rig).norm(), 1e-9);
}

// Slow projectors as well: what they promise of their pictures tells the delay, nobody needs to say it.
TEST_F(OverlayTest, DrawsWhereTheMovingPatientWillBeWhenTheLightArrives) {
    for (const Instant delay : {10ms, 25ms, 75ms}) {
        projector.delay = delay;
        OverlayLoop loop(projector, clock, renderer, drawing, registration);
        const Instant from = clock.time;
        OverlayStep last;
        for (int frame = 0; frame < 60; ++frame) {  // 20 mm/s to the left, a pose every 16 ms, seen 20 ms later
            clock.time += 16ms;
            TrackedPose p = pose(20ms);
            p.rig_from_patient->translation().x() = 20 * seconds(p.at - from);
            last = loop.step(p);
            ASSERT_TRUE(last.lit) << last.reason;
        }
        // In the middle of the 16 ms that the picture will be light. Unpredicted it would lag by 0.8 to 2.1 mm.
        const double truth_mm = 20 * seconds(clock.time + delay + 8ms - from);
        EXPECT_NEAR(last.rig_from_ct.translation().x(), truth_mm, 0.1) << seconds(delay);
    }
}

TEST_F(OverlayTest, LightThatIsFoundToComeLaterIsDrawnFurtherAhead) {
    OverlayLoop loop(projector, clock, renderer, drawing, registration);
    loop.set_found_delay(20ms);
    EXPECT_EQ(loop.light_delay(), 45ms);
    loop.step(pose());
    EXPECT_EQ(loop.light_delay(), 45ms) << "beside what the projector promises";
}

// Nobody knows where a moving head will be in half a second; one that lies still is where it was.
TEST_F(OverlayTest, AVerySlowProjectorLightsAHeadThatLiesStillAndNoOther) {
    projector.delay = 400ms;
    OverlayLoop loop(projector, clock, renderer, drawing, registration);
    for (int frame = 0; frame < 20; ++frame) {
        clock.time += 16ms;
        EXPECT_TRUE(loop.step(pose()).lit);
    }
    EXPECT_LT(loop.spare_time(), Instant{});
    const Instant from = clock.time;
    OverlayStep last;
    for (int frame = 0; frame < 40; ++frame) {  // 5 mm/s: unpredicted 1.5 mm
        clock.time += 16ms;
        TrackedPose p = pose();
        p.rig_from_patient->translation().x() = 5 * seconds(p.at - from);
        last = loop.step(p);
    }
    EXPECT_FALSE(last.lit);
    EXPECT_NE(last.reason.find("the head moves, and light comes"), std::string::npos) << last.reason;
    for (int frame = 0; frame < 60; ++frame) {
        clock.time += 16ms;
        TrackedPose p = pose();
        p.rig_from_patient->translation().x() = 3.2;
        last = loop.step(p);
    }
    EXPECT_TRUE(last.lit) << "it lies still again: " << last.reason;
}

}  // namespace
}  // namespace planlight
