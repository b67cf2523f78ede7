// The light's own check in rooms and with plans that it was not made for: light that lies 2.5 mm aside is never said to
// be right, and good light never put out.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "app/prepare_case.h"
#include "app/session.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/volume/read_volume.h"
#include "projection/check_light.h"
#include "projection/darkness_check.h"
#include "projection/light_gate.h"
#include "registration/simulation/simulated_rig.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;

class StrangeLight : public testing::Test {
protected:
    static void SetUpTestSuite() {
        if (!example_patient()) return;
        volume_ = read_volume(*example_patient());
        const auto prepared =
            prepare_case(*volume_, read_plan(std::string(PLANLIGHT_EXAMPLE_FOLDER) + "/frontal_defect.mrk.json"), {},
                         {}, "2001-10-14");
        case_ = prepared.prepared;
        threshold_ = prepared.threshold;
    }
    void SetUp() override {
        if (!volume_) GTEST_SKIP() << "the package invesalius-examples is not installed";
        room_.preset = simulation::Preset::paper;
        room_.seed = 11;
        room_.skin_threshold_hu = threshold_;
    }

    struct Seen {
        LightCheck check;
        LightGate::Ruling ruling;
    };
    /// The plan drawn `aside_mm` along the skin, seen in some frames by a gate whose light a person has verified.
    static Seen seen(simulation::SimulatedRig& rig, const Plan& plan, double aside_mm) {
        Case the_case = *case_;
        the_case.plan = plan;
        const CaseDrawing drawing(the_case);
        const RigidTransform rig_from_ct = rig.true_rig_from_ct(rig.clock().now());
        const Vector3d p = points_of(plan).front();
        const Vector3d normal = drawing.skin.nearest(p).normal_in_ct;
        // Neither along the line of the one-line plan nor across it.
        const Vector3d aside = aside_mm * (normal.cross(Vector3d(0.2, 0.1, 1))).normalized();
        const DrawingRenderer renderer(drawing.skin, rig.calibration().projector);
        const Instant lit = rig.projector().show(
            renderer.render(drawing.drawing, rig_from_ct * Eigen::Translation3d(aside)), rig.clock().now() + 10s);
        LightChecker checker(drawing.drawing, drawing.skin, rig.calibration());
        LightGate gate;
        gate.verify(rig.clock().now());
        Seen seen;
        for (int i = 0; i < 6; ++i) {
            const StereoFrame frame = rig.cameras().grab(lit, 1s);
            seen.check = checker.look(rig_from_ct, frame);
            seen.ruling = gate.step(frame.at, true, seen.check);
            if (seen.ruling.stop) break;
        }
        return seen;
    }

    void expect_honest(const std::string& name, const Plan& plan) {
        simulation::SimulatedRig rig(*volume_, points_of(plan), room_);
        const Seen good = seen(rig, plan, 0), off = seen(rig, plan, 2.5);
        for (const auto& [what, s] : {std::pair("good", &good), {"2.5 mm aside", &off}})
            fmt::print("{:<22} {:<13} seen {:>3} of {:>3}, 95 % {:.2f} mm: {} {}\n", name, what, s->check.seen,
                       s->check.expected, s->check.off_mm,
                       s->ruling.stop                           ? "DARK"
                       : s->ruling.trust == LightTrust::aligned ? "ALIGNED"
                                                                : "CHECK",
                       s->ruling.headline);
        EXPECT_FALSE(good.ruling.stop) << name << ": " << good.ruling.headline;
        EXPECT_NE(off.ruling.trust, LightTrust::aligned) << name << ": " << off.ruling.headline;
        green_ = good.ruling.trust == LightTrust::aligned;
    }
    const Plan& example() const { return case_->plan; }
    /// Near the middle of the example's plan, on the skin.
    static Vector3d middle() { return case_->plan.boreholes.front().position_in_ct; }

    static Plan biopsy_straight_in() {
        Plan plan;
        Trajectory way;
        way.name = "Biopsy";
        way.entry_in_ct = middle();
        way.target_in_ct = middle() - 60 * CaseDrawing(*case_).skin.nearest(middle()).normal_in_ct;
        plan.trajectories = {way};
        return plan;
    }
    /// Six holes of 2.4 mm in two rows, 7 mm apart, with short names.
    static Plan screws_of_a_plate() {
        const CaseDrawing drawing(*case_);
        const auto at = drawing.skin.nearest(middle());
        const Vector3d u = at.normal_in_ct.cross(Vector3d(0.2, 0.1, 1)).normalized(), v = at.normal_in_ct.cross(u);
        Plan plan;
        for (int i = 0; i < 6; ++i) {
            Borehole hole;
            hole.name = fmt::format("S{}", i + 1);
            hole.position_in_ct = drawing.skin.nearest(at.p_in_ct + 7.0 * (i % 3) * u + 7.0 * (i / 3) * v).p_in_ct;
            hole.diameter_mm = 2.4;
            plan.boreholes.push_back(hole);
        }
        return plan;
    }

    simulation::RoomSettings room_;
    bool green_ = false;
    static std::optional<Volume> volume_;
    static std::optional<Case> case_;
    static double threshold_;
};
std::optional<Volume> StrangeLight::volume_;
std::optional<Case> StrangeLight::case_;
double StrangeLight::threshold_ = 0;

TEST_F(StrangeLight, GoodLightInAPlainRoomIsGreen) {
    expect_honest("plain", example());
    EXPECT_TRUE(green_);
}

TEST_F(StrangeLight, BrightTheatreLight) {
    room_.ambient = 0.55;
    expect_honest("bright room", example());
}

TEST_F(StrangeLight, GlossySkin) {
    room_.wet = 1;
    expect_honest("glossy skin", example());
}

TEST_F(StrangeLight, ClothOverAPartOfTheLight) {
    room_.things.drape_hole = true;
    room_.things.hole_mm = 25;
    expect_honest("cloth, hole of 25 mm",
                  example());  // thin, and laid on the skin: its light lies where the skin's would
}

TEST_F(StrangeLight, AHandInTheLight) {
    room_.things.hand = true;
    expect_honest("a hand", example());
}

TEST_F(StrangeLight, OneStraightLine) {
    Plan plan;
    OsteotomyLine line = example().osteotomy_lines.front();
    line.points_in_ct = {example().boreholes.front().position_in_ct, example().boreholes.back().position_in_ct};
    line.closed = false;
    plan.osteotomy_lines = {line};
    expect_honest("one straight line", plan);
}

TEST_F(StrangeLight, OneShortLineIsToldByItsMarks) {
    Plan plan;
    OsteotomyLine line = example().osteotomy_lines.front();
    const Vector3d way = (line.points_in_ct[1] - line.points_in_ct[0]).normalized();
    line.points_in_ct = {line.points_in_ct[0], line.points_in_ct[0] + 9 * way};
    line.closed = false;
    plan.osteotomy_lines = {line};
    expect_honest("one line of 9 mm", plan);
    EXPECT_TRUE(green_) << "the marks at its ends tell where it lies along itself";
}

TEST_F(StrangeLight, OneSmallCircle) {
    Plan plan;
    Borehole hole = example().boreholes.front();
    hole.diameter_mm = 2;
    plan.boreholes = {hole};
    expect_honest("one hole of 2 mm", plan);
    EXPECT_TRUE(green_);
}

TEST_F(StrangeLight, OneBiopsyStraightIn) {
    expect_honest("one biopsy", biopsy_straight_in());
    EXPECT_TRUE(green_);
}

TEST_F(StrangeLight, ThePlateOfScrewsIsToldScrewByScrew) {
    for (const auto preset : {simulation::Preset::paper, simulation::Preset::modern}) {
        room_.preset = preset;
        expect_honest("six screws of a plate", screws_of_a_plate());
        EXPECT_TRUE(green_);
    }
}

// One item is looked at, and what it is lit by is covered: the dim ring beside it is not its light.
TEST_F(StrangeLight, ADimNeighbourIsNotTakenForTheItemOfTheMoment) {
    const CaseDrawing before(*case_);
    const SkinSurface& skin = before.skin;
    const auto at = skin.nearest(middle());
    const Vector3d beside = at.normal_in_ct.cross(Vector3d(0.2, 0.1, 1)).normalized();
    Plan plan;
    for (int i = 0; i < 2; ++i) {
        Borehole hole;
        hole.name = fmt::format("Hole {}", i + 1);
        hole.position_in_ct = skin.nearest(at.p_in_ct + 9.0 * i * beside).p_in_ct;
        hole.diameter_mm = 7;
        plan.boreholes.push_back(hole);
    }
    Case the_case = *case_;
    the_case.plan = plan;
    const CaseDrawing drawing(the_case);
    simulation::SimulatedRig rig(*volume_, points_of(plan), room_);
    const RigidTransform rig_from_ct = rig.true_rig_from_ct(rig.clock().now());
    const DrawingRenderer renderer(drawing.skin, rig.calibration().projector);
    const auto check = [&](int lit_item, double brightness) {
        RenderSettings render;
        render.only_item = lit_item;
        render.brightness = brightness;
        const RgbImage picture = renderer.render(drawing.drawing, rig_from_ct, RigidTransform::Identity(), render);
        const Instant lit = rig.projector().show(picture, rig.clock().now() + 10s);
        LightChecker checker(drawing.drawing, drawing.skin, rig.calibration(), {}, 0);
        return checker.look(rig_from_ct, rig.cameras().grab(lit, 1s));
    };
    const LightCheck own = check(0, 1), other = check(1, 0.25);
    for (const SeenSegment& segment : other.segments) EXPECT_EQ(segment.item, 0);
    EXPECT_GE(own.seen_share(), 0.8);
    EXPECT_LE(other.seen_share(), 0.2) << other.seen << " of " << other.expected;
}

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

/// The cameras tell it by a few stretches alone, of its ring and marks.
TEST_F(StrangeLight, OneScrewThatStaysLitAloneIsSeen) {
    room_.preset = simulation::Preset::paper;
    Case the_case = *case_;
    the_case.plan = screws_of_a_plate();
    const CaseDrawing drawing(the_case);
    simulation::SimulatedRig rig(*volume_, points_of(the_case.plan), room_);
    const RigidTransform rig_from_ct = rig.true_rig_from_ct(rig.clock().now());
    const DrawingRenderer renderer(drawing.skin, rig.calibration().projector);
    int told = 0;
    for (std::size_t screw = 0; screw < drawing.drawing.items.size(); ++screw) {
        RenderSettings one;
        one.only_item = static_cast<int>(screw);
        PlanDrawing alone = drawing.drawing;
        std::erase_if(alone.strokes, [&](const Stroke& s) { return s.item != static_cast<int>(screw); });
        std::erase_if(alone.labels, [&](const Label& l) { return l.item != static_cast<int>(screw); });
        const RgbImage picture = renderer.render(drawing.drawing, rig_from_ct, RigidTransform::Identity(), one);
        const Instant lit = rig.projector().show(picture, rig.clock().now() + 10s);
        const StereoFrame frame = rig.cameras().grab(lit, 1s);
        const LightCheck check = LightChecker(alone, drawing.skin, rig.calibration()).look(rig_from_ct, frame);
        if (check.seen < 2) continue;  // not told apart while it is lit either
        ++told;
        DarknessCheck darkness({alone, rig_from_ct, light_grey(check)}, drawing.skin, rig.calibration());
        int looks = 0;  // of which one now and then may miss it
        for (int i = 0; i < 10; ++i) looks += darkness.look(rig.cameras().grab(rig.clock().now(), 1s)) ? 1 : 0;
        EXPECT_GE(looks, 4) << screw << ": " << check.seen << " of " << check.expected << ", " << check.off_mm << " mm";
        rig.projector().go_dark();
        rig.wait(300ms);
        for (int i = 0; i < 3; ++i) {
            darkness.look(rig.cameras().grab(rig.clock().now(), 1s));
            EXPECT_FALSE(i > 0 && darkness.lit()) << screw;
        }
    }
    EXPECT_GE(told, 3);
}

TEST_F(FarLight, OfAPlanGoesDark) {
    expect_dark("example", example());
}

TEST_F(FarLight, OfOneHoleGoesDark) {
    Plan plan;
    Borehole hole = example().boreholes.front();
    hole.diameter_mm = 2;
    plan.boreholes = {hole};
    expect_dark("one hole of 2 mm", plan);
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

TEST_F(StrangeLight, APlanFullOfText) {
    Plan plan;
    for (int i = 0; i < 16; ++i) {
        Borehole hole = example().boreholes.front();
        hole.name = fmt::format("A hole with a very long name {}", i);
        hole.diameter_mm = 3;
        hole.position_in_ct = middle() + Vector3d(9.0 * (i % 4) - 13, 0, 9.0 * (i / 4) - 13);
        plan.boreholes.push_back(hole);
    }
    expect_honest("16 holes 9 mm apart", plan);
    EXPECT_TRUE(green_) << "none has room for marks: each is told as a pattern";
}

}  // namespace
}  // namespace planlight::test
