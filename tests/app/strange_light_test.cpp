// The light's own check in rooms and with plans that it was not made for: light that lies 2.5 mm aside is never said to
// be right, and good light never put out.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "projection/darkness_check.h"
#include "tests/app/strange_light.h"

namespace planlight::test {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;

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
    expect_honest("one hole of 2 mm", one_hole_of_2_mm());
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
