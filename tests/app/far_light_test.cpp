// Light so far aside that nobody sees it near its place is found there, and put out; light that is covered is not.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/app/strange_light.h"

namespace planlight::test {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;

/// A knocked projector whose light lies so far aside that nobody sees it near its place.
class FarLight : public StrangeLight {
protected:
    struct Result {
        LightCheck check;
        LightGate::Ruling ruling;
    };
    /// A room with the plan lit by a projector that stands as it was calibrated, `knock` and back again.
    class LitRoom {
    public:
        LitRoom(const Plan& plan, const simulation::RoomSettings& room)
            : case_(with(plan)), drawing_(case_), rig_(*volume_, points_of(plan), room) {}

        /// `mm` on the skin; what a gate of verified light makes of four frames.
        Result after_knock(const Eigen::Vector2d& mm) {
            const RigidTransform rig_from_ct = rig_.true_rig_from_ct(rig_.clock().now());
            const CameraModel& projector = rig_.calibration().projector;
            const double away_mm = (projector.device_from_rig * (rig_from_ct * points_of(case_.plan).front())).z();
            const Vector3d turn(mm.y() / away_mm, -mm.x() / away_mm, 0);
            rig_.bump(simulation::SimulatedRig::Device::projector, turn);
            const Instant lit =
                rig_.projector().show(DrawingRenderer(drawing_.skin, projector).render(drawing_.drawing, rig_from_ct),
                                      rig_.clock().now() + 10s);
            LightChecker checker(drawing_.drawing, drawing_.skin, rig_.calibration());
            LightGate gate;
            gate.verify(rig_.clock().now());
            Result result;
            for (int i = 0; i < 4 && !result.ruling.stop; ++i) {
                const StereoFrame frame = rig_.cameras().grab(lit, 1s);
                result.check = checker.look(rig_from_ct, frame);
                result.ruling = gate.step(frame.at, true, result.check);
            }
            rig_.bump(simulation::SimulatedRig::Device::projector, -turn);
            return result;
        }

    private:
        static Case with(const Plan& plan) {
            Case the_case = *StrangeLight::case_;
            the_case.plan = plan;
            return the_case;
        }
        Case case_;
        CaseDrawing drawing_;
        simulation::SimulatedRig rig_;
    };

    void report(const std::string& what, const Result& r) {
        fmt::print("{:<40} seen {:>3} of {:>3}, far {:<5} {} {}\n", what, r.check.seen, r.check.expected,
                   r.check.far_mm ? fmt::format("{:.1f}", *r.check.far_mm) : "-", r.ruling.stop ? "DARK " : "CHECK",
                   r.ruling.headline);
    }
    /// Three directions at three distances: none may be green, most go dark, and the figure is about right.
    void expect_dark(const std::string& name, const Plan& plan) {
        LitRoom room(plan, room_);
        int dark = 0;
        for (const double mm : {3.5, 5.5, 10.0})
            for (int k = 0; k < 3; ++k) {
                const double angle = 0.4 + k * 2 * std::numbers::pi / 3;
                const Result r = room.after_knock(mm * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
                report(fmt::format("{}, {} mm at {:.0f} degrees", name, mm, angle * 57.3), r);
                dark += r.ruling.stop;
                EXPECT_NE(r.ruling.trust, LightTrust::aligned) << name << " " << mm;
                EXPECT_NEAR(r.check.far_mm.value_or(mm), mm, 0.3 * mm) << name;
            }
        EXPECT_GE(dark, 7) << "of 9: " << name;
    }
};

TEST_F(FarLight, OfAPlanGoesDark) {
    expect_dark("example", example());
}

TEST_F(FarLight, OfOneHoleGoesDark) {
    expect_dark("one hole of 2 mm", one_hole_of_2_mm());
}

TEST_F(FarLight, OfThePlateOfScrewsGoesDark) {
    expect_dark("screws", screws_of_a_plate());
}

TEST_F(FarLight, OfOneBiopsyGoesDark) {
    expect_dark("one biopsy", biopsy_straight_in());
}

/// A minute each: not in the short run.
class FarLightInOtherRooms : public FarLight {};

TEST_F(FarLightInOtherRooms, OfTheModernKindGoesDark) {
    room_.preset = simulation::Preset::modern;
    expect_dark("modern, example", example());
}

TEST_F(FarLightInOtherRooms, UnderBrightLampsOnGlossySkinGoesDark) {
    room_.ambient = 0.4;
    room_.wet = 0.7;
    expect_dark("bright, wet", example());
}

/// Light that is where it belongs, what there is of it: something before it is no reason to put it out.
TEST_F(FarLight, IsNotSeenInLightThatIsCoveredOrFallsOnAHand) {
    for (const unsigned seed : {11U, 12U})
        for (int thing = 0; thing < 5; ++thing) {
            room_.seed = seed;
            room_.things = {};
            room_.things.hand = thing == 0 || thing == 4;
            room_.things.drape_hole = thing == 1;
            room_.things.hole_mm = 60;
            room_.things.hair = thing == 2;
            room_.things.retractor = thing == 3 || thing == 4;
            room_.things.tube = thing == 4;
            const Result r = LitRoom(example(), room_).after_knock({0, 0});
            report(fmt::format("seed {}, thing {}", seed, thing), r);
            EXPECT_FALSE(r.check.far_mm) << seed << " " << thing;
            EXPECT_FALSE(r.ruling.stop) << seed << " " << thing;
        }
}

/// None, or another: the cameras see skin, stickers and the room, or lines that are not the plan's.
TEST_F(FarLight, IsNotSeenWhereThereIsNone) {
    for (const unsigned seed : {11U, 12U})
        for (const bool other : {false, true}) {
            room_.seed = seed;
            simulation::SimulatedRig rig(*volume_, points_of(example()), room_);
            const CaseDrawing drawing(*case_);
            const RigidTransform rig_from_ct = rig.true_rig_from_ct(rig.clock().now());
            const CameraModel& projector = rig.calibration().projector;
            RgbImage picture(projector.width, projector.height);
            for (int y = 0; other && y < picture.height; ++y)  // a desktop: windows' frames and lines of text
                for (int x = 0; x < picture.width; ++x)
                    if (x % 97 < 2 || y % 61 < 2 || (y % 16 < 2 && x % 7 < 4)) picture.at(x, y) = {255, 255, 255};
            const Instant lit = rig.projector().show(picture, rig.clock().now() + 10s);
            LightChecker checker(drawing.drawing, drawing.skin, rig.calibration());
            for (int i = 0; i < 3; ++i) {
                const LightCheck check = checker.look(rig_from_ct, rig.cameras().grab(lit, 1s));
                EXPECT_FALSE(check.far_mm) << (other ? "a desktop: " : "black: ") << check.far_mm.value_or(0);
            }
        }
}

}  // namespace
}  // namespace planlight::test
