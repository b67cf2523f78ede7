// Light on skin that is no longer as high as it was scanned, too steep to be measured, or out of the cameras' sight: as
// cameras see it that share no code with what looks (`lit_ball`).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "projection/check_light.h"
#include "projection/light_gate.h"
#include "projection/render_drawing.h"
#include "projection/stroke_places.h"
#include "tests/projection/lit_ball.h"
#include "tests/projection/shapes.h"

namespace planlight {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector3d;

Borehole hole(const std::string& name, double longitude, double latitude, double diameter_mm = 12) {
    const Vector3d at = test::on_ball(longitude, latitude);
    return {name, at, Vector3d(-at.normalized()), diameter_mm, 8, {}};
}

PlanDrawing drawing_of(const Plan& plan) {
    DrawingSettings settings;
    settings.labels = false;
    return draw_plan(plan, test::ball(), settings);
}

/// What a verified gate says after the same look ten times.
LightGate::Ruling ruling_of(const LightCheck& check) {
    LightGate gate;
    gate.verify({});
    LightGate::Ruling ruling;
    for (int i = 1; i <= 10; ++i) ruling = gate.step(i * 100ms, true, check);
    return ruling;
}

/// How far the light that was aimed at `p` lies beside the place on the risen skin over it.
double aside_mm(const Vector3d& p, double risen_mm, const RigCalibration& rig) {
    const Vector3d out = p.normalized(), to_light = (rig.projector.centre_in_rig() - p).normalized();
    const double cosine = out.dot(to_light);
    return std::abs(risen_mm) * std::sqrt(1 - cosine * cosine) / cosine;
}

/// One item's skin rises or sinks after the scan, as by an injection under it: each camera sees the light aside, to
/// opposite sides, or square to the cameras' base not at all.
TEST(SkinHeight, LightOnSkinThatHasRisenUnderOneItemLiesAsideByItsSlant) {
    const RigCalibration rig = test::rig_before_ball();
    Plan plan;
    plan.boreholes = {hole("Hole 1", 0.1, 0.35), hole("Hole 2", 0.5, 0.3), hole("Hole 3", 0.3, 0.65)};
    for (const double latitude : {-0.35, -0.55}) {  // the light comes at 43 and at 54 degrees
        plan.boreholes.resize(3);
        plan.boreholes.push_back(hole("Swollen", 0.3, latitude));
        const PlanDrawing drawing = drawing_of(plan);
        for (const double risen_mm : {-2.5, -1.4, 0.0, 1.4, 2.5, 4.0}) {
            test::LitBall lit;
            lit.swollen = plan.boreholes.back().position_in_ct;
            lit.swollen_mm = risen_mm;
            const LightCheck check = check_light(drawing, test::ball(), rig, RigidTransform::Identity(),
                                                 test::pictures_of(drawing, rig, lit));
            ASSERT_EQ(check.items.size(), 4u);
            const ItemLight& swollen = check.items[3];
            const double truth_mm = aside_mm(plan.boreholes.back().position_in_ct, risen_mm, rig);
            std::printf("risen by %4.1f mm at latitude %.2f: light %.2f mm aside, told %.2f, depth %s (%d of %d)\n",
                        risen_mm, latitude, truth_mm, swollen.off_mm,
                        swollen.depth_mm ? std::to_string(*swollen.depth_mm).c_str() : "not told", swollen.seen,
                        swollen.segments);
            EXPECT_NEAR(swollen.off_mm, truth_mm, 0.3 + 0.15 * truth_mm);
            for (int k = 0; k < 3; ++k) EXPECT_LT(check.items[static_cast<std::size_t>(k)].off_mm, 0.2);
            const LightGate::Ruling ruling = ruling_of(check);
            EXPECT_EQ(ruling.trust == LightTrust::aligned, truth_mm < 1) << ruling.headline;
            if (risen_mm == 0) {
                EXPECT_FALSE(swollen.depth_mm);
            } else {
                ASSERT_TRUE(swollen.depth_mm);
                EXPECT_NEAR(*swollen.depth_mm, risen_mm, 0.3 + 0.15 * std::abs(risen_mm));
                if (truth_mm > 1.2) {
                    EXPECT_NE(ruling.headline.find("Swollen"), std::string::npos) << ruling.headline;
                }
            }
        }
    }
}

/// One camera alone tells no height: of light that lies aside by it, it sees a part only.
TEST(SkinHeight, AnItemThatOneCameraAloneSeesOnRisenSkinIsNoGreen) {
    for (const double latitude : {-0.35, -0.55, -0.7})
        for (const bool left_alone : {true, false}) {
            Plan plan;
            plan.boreholes = {hole("Hole 1", 0.1, 0.35), hole("Hole 2", 0.5, 0.3), hole("Hole 3", 0.3, 0.65),
                              hole("Swollen", 0.3, latitude)};
            const PlanDrawing drawing = drawing_of(plan);
            RigCalibration rig = test::rig_before_ball();
            CameraModel& blind = left_alone ? rig.right_camera : rig.left_camera;
            blind.height = static_cast<int>(project(blind, test::on_ball(0.3, latitude + 0.15))->y());
            for (const double risen_mm : {-2.5, -1.8, -1.4, 0.0, 1.4, 1.8, 2.5}) {
                test::LitBall lit;
                lit.swollen = plan.boreholes.back().position_in_ct;
                lit.swollen_mm = risen_mm;
                const LightCheck check = check_light(drawing, test::ball(), rig, RigidTransform::Identity(),
                                                     test::pictures_of(drawing, rig, lit));
                const ItemLight& swollen = check.items[3];
                ASSERT_GT(swollen.seen, 0);
                const double truth_mm = aside_mm(plan.boreholes.back().position_in_ct, risen_mm, rig);
                const LightGate::Ruling ruling = ruling_of(check);
                std::printf("one camera, latitude %.2f, risen by %4.1f: %.2f aside, told %.2f, by height %.2f: %s\n",
                            latitude, risen_mm, truth_mm, swollen.off_mm, swollen.by_untold_height_mm,
                            ruling.headline.c_str());
                for (int k = 0; k < 3; ++k) EXPECT_EQ(check.items[static_cast<std::size_t>(k)].by_untold_height_mm, 0);
                if (risen_mm == 0 && latitude > -0.6) {  // beyond that it is measured in part only
                    EXPECT_EQ(ruling.trust, LightTrust::aligned) << ruling.headline;
                }
                if (truth_mm > 2) {
                    EXPECT_EQ(ruling.trust, LightTrust::look);
                    EXPECT_NE(ruling.headline.find("Swollen"), std::string::npos) << ruling.headline;
                }
            }
        }
}

/// The rest of a line, seen by both, says nothing of the part that one alone sees; nor do both of one along their base,
/// but by its ticks.
TEST(SkinHeight, APartOfALineThatOneCameraAloneSeesOnRisenSkinIsNoGreen) {
    for (const double latitude : {-0.1, -0.4, -0.55})
        for (const bool all_by_both : {true, false}) {
            RigCalibration rig = test::rig_before_ball();
            Plan plan;
            plan.boreholes = {hole("Hole 1", 0.1, 0.35), hole("Hole 2", 0.5, 0.3), hole("Hole 3", 0.3, 0.65)};
            OsteotomyLine line;
            line.name = "Line";
            for (double longitude = -0.25; longitude < 0.86; longitude += 0.1)
                line.points_in_ct.push_back(test::on_ball(longitude, latitude));
            plan.osteotomy_lines.push_back(line);
            const PlanDrawing drawing = drawing_of(plan);
            if (!all_by_both)
                rig.right_camera.width =
                    static_cast<int>(project(rig.right_camera, test::on_ball(0.45, latitude))->x());
            for (const double risen_mm : {-2.5, -1.8, 0.0, 1.8, 2.5}) {
                test::LitBall lit;
                lit.swollen = test::on_ball(0.7, latitude);
                lit.swollen_mm = risen_mm;
                const LightCheck check = check_light(drawing, test::ball(), rig, RigidTransform::Identity(),
                                                     test::pictures_of(drawing, rig, lit));
                const auto cut_light = std::ranges::find(check.items, "Line", &ItemLight::name);
                ASSERT_NE(cut_light, check.items.end());
                const double truth_mm = aside_mm(*lit.swollen, risen_mm, rig);
                const LightGate::Ruling ruling = ruling_of(check);
                std::printf(
                    "%s, latitude %.2f, risen by %4.1f: %.2f aside, told %.2f, a part %.2f, by height %.2f: %s\n",
                    all_by_both ? "both" : "one", latitude, risen_mm, truth_mm, cut_light->off_mm,
                    cut_light->part_off_mm, cut_light->by_untold_height_mm, ruling.headline.c_str());
                if (truth_mm > 2) {
                    EXPECT_EQ(ruling.trust, LightTrust::look);
                    if (check.off_mm <= 1) {
                        EXPECT_NE(ruling.headline.find("Line"), std::string::npos) << ruling.headline;
                    }
                }
                if (risen_mm == 0 && all_by_both && latitude > -0.5) {
                    EXPECT_EQ(ruling.trust, LightTrust::aligned) << ruling.headline;
                }
            }
        }
}

/// The skin has risen under a part of a long line, by an injection or a retractor say: most of it lies right, and 95 %
/// of all the light, but that part lies millimetres aside.
/// `dashed`: the trace of a cut plane, else an osteotomy line.
void expect_no_green_on_risen_part(bool dashed) {
    struct Cut {
        double longitude[2], latitude[2], at;  ///< from where to where, and the share of its way that has risen
    };
    const RigCalibration rig = test::rig_before_ball();
    for (const Cut& cut : {Cut{{0.95, 0.95}, {-0.35, 1.0}, 0.5}, Cut{{0.95, 0.95}, {-0.35, 1.0}, 0.15},
                           Cut{{-0.4, -0.4}, {-0.2, 1.0}, 0.2}}) {
        const auto along = [&](double share) {
            return test::on_ball(std::lerp(cut.longitude[0], cut.longitude[1], share),
                                 std::lerp(cut.latitude[0], cut.latitude[1], share));
        };
        Plan plan;
        plan.boreholes = {hole("Hole 1", 0.1, 0.35), hole("Hole 2", 0.5, 0.3),  hole("Hole 3", 0.3, 0.65),
                          hole("Hole 4", -0.1, 0.6), hole("Hole 5", 0.7, 0.65), hole("Hole 6", 0.3, 0.05)};
        std::vector<Vector3d> points;
        for (int k = 0; k <= 16; ++k) points.push_back(along(k / 16.0));
        if (dashed) {
            CutPlane plane;
            plane.name = "Line";
            plane.origin_in_ct = points[8];
            plane.normal_in_ct = points.front().cross(points.back()).normalized();
            plane.first_axis_in_ct = (points.back() - points.front()).normalized();
            plane.width_mm = (points.back() - points.front()).norm();
            plane.height_mm = 60;
            plan.cut_planes.push_back(plane);
        } else {
            OsteotomyLine line;
            line.name = "Line";
            line.points_in_ct = points;
            plan.osteotomy_lines.push_back(line);
        }
        const PlanDrawing drawing = drawing_of(plan);
        for (const double risen_mm : {0.0, 3.0, 4.0, 6.0}) {
            test::LitBall lit;
            lit.swollen = along(cut.at);
            lit.swollen_mm = risen_mm;
            const LightCheck check = check_light(drawing, test::ball(), rig, RigidTransform::Identity(),
                                                 test::pictures_of(drawing, rig, lit));
            const auto cut_light = std::ranges::find(check.items, "Line", &ItemLight::name);
            ASSERT_NE(cut_light, check.items.end());
            const LightGate::Ruling ruling = ruling_of(check);
            std::printf("risen by %.0f mm at %.2f of the way: %.2f mm aside; all of the line %.2f, a part %.2f: %s\n",
                        risen_mm, cut.at, aside_mm(*lit.swollen, risen_mm, rig), cut_light->off_mm,
                        cut_light->part_off_mm, ruling.headline.c_str());
            EXPECT_EQ(ruling.trust == LightTrust::aligned, risen_mm == 0) << ruling.headline;
            if (risen_mm == 0) {
                EXPECT_LT(cut_light->part_off_mm, 0.3);
            } else if (check.off_mm <= 1) {
                EXPECT_NE(ruling.headline.find("Line"), std::string::npos) << ruling.headline;
            }
        }
    }
}

TEST(SkinHeight, APartOfALineOnRisenSkinIsNoGreen) {
    expect_no_green_on_risen_part(false);
}

TEST(SkinHeight, APartOfACutPlanesTraceOnRisenSkinIsNoGreen) {
    expect_no_green_on_risen_part(true);
}

/// What the projector lights, the gate knows of, though it is too steep to be measured.
TEST(SkinHeight, AnItemThatIsLitButTooSteepToBeMeasuredIsNoGreen) {
    EXPECT_EQ(RenderSettings{}.steepest, CheckLightSettings{}.steepest_lit);
    const RigCalibration rig = test::rig_before_ball();
    Plan plan;
    // The light falls at 1.24 radians there.
    plan.boreholes = {hole("Hole 1", 0.1, 0.35), hole("Hole 2", 0.5, 0.3), hole("Hole 3", 0.3, 0.65),
                      hole("Steep", 0.3, 0.4 - 1.13, 4)};
    const PlanDrawing drawing = drawing_of(plan);
    RgbImage picture;
    const RenderCounts counts =
        DrawingRenderer(test::ball(), rig.projector).render_into(picture, drawing, RigidTransform::Identity());
    ASSERT_GT(counts.items[3].lit_share(), 0.95);
    const LightCheck check =
        check_light(drawing, test::ball(), rig, RigidTransform::Identity(), test::pictures_of(drawing, rig, {}));
    EXPECT_TRUE(check.items[3].lit);
    EXPECT_LT(2 * check.items[3].segments, check.items[3].lit_segments) << "steeper than what is measured";
    EXPECT_GT(2 * check.items[3].steep_segments, check.items[3].lit_segments);
    EXPECT_EQ(check.items[0].steep_segments, 0);
    const LightGate::Ruling ruling = ruling_of(check);
    EXPECT_EQ(ruling.trust, LightTrust::look);
    EXPECT_NE(ruling.headline.find("Steep"), std::string::npos) << ruling.headline;
}

/// One item alone is bright, at the operator's press: what the others' dim light shows is not lost in its green.
TEST(SkinHeight, ADimItemOnRisenSkinIsNoGreenOfTheBrightOne) {
    const RigCalibration rig = test::rig_before_ball();
    Plan plan;
    plan.boreholes = {hole("Hole 1", 0.1, 0.35), hole("Hole 2", 0.5, 0.3), hole("Swollen", 0.3, -0.35)};
    const PlanDrawing drawing = drawing_of(plan);
    for (const double risen_mm : {0.0, 2.5}) {
        test::LitBall lit;
        lit.swollen = plan.boreholes.back().position_in_ct;
        lit.swollen_mm = risen_mm;
        const StereoFrame pictures = test::pictures_of(drawing, rig, lit);
        const LightCheck check =
            LightChecker(drawing, test::ball(), rig, {}, 0).look(RigidTransform::Identity(), pictures);
        EXPECT_FALSE(check.items[0].dim);
        EXPECT_TRUE(check.items[2].dim);
        EXPECT_LT(check.off_mm, 0.3) << "of the bright one";
        for (const SeenSegment& s : check.segments) EXPECT_EQ(s.item, 0);
        const LightGate::Ruling ruling = ruling_of(check);
        EXPECT_EQ(ruling.trust == LightTrust::aligned, risen_mm == 0) << ruling.headline;
        if (risen_mm > 0) {
            EXPECT_NE(ruling.headline.find("Swollen"), std::string::npos) << ruling.headline;
        }
    }
}

/// Where two items lie side by side neither's light can be told from the other's: such a line is measured in part.
TEST(SkinHeight, ALineBesideAnotherForMostOfItsWayIsMeasuredInPartOnly) {
    const RigCalibration rig = test::rig_before_ball();
    for (const double together : {0.0, 0.7}) {
        Plan plan;
        plan.boreholes = {hole("Hole 1", 0.25, 0.75), hole("Hole 2", 0.25, 0.0)};
        OsteotomyLine line, other;
        line.name = "Line", other.name = "Other";
        for (double share = 0; share < 1.01; share += 0.1) {
            const double longitude = -0.2 + share, apart_mm = share <= together ? 1.8 : 1.8 + 25 * (share - together);
            line.points_in_ct.push_back(test::on_ball(longitude, 0.35));
            other.points_in_ct.push_back(
                test::on_ball(longitude, 0.35 + (together > 0 ? apart_mm : 12) / test::kBallRadius_mm));
        }
        plan.osteotomy_lines = {line, other};
        const PlanDrawing drawing = drawing_of(plan);
        const LightCheck check =
            check_light(drawing, test::ball(), rig, RigidTransform::Identity(), test::pictures_of(drawing, rig, {}));
        const LightGate::Ruling ruling = ruling_of(check);
        EXPECT_EQ(ruling.headline,
                  together > 0 ? "LOOK: \"Line\" is measured in part only." : "The plan is on the skin.")
            << together;
    }
}

/// Holes at the corners of an outline are crossed by its line: what is seen of such a hole stands for all of it.
TEST(SkinHeight, HolesThatALineLeadsThroughAreMeasured) {
    const RigCalibration rig = test::rig_before_ball();
    Plan plan;
    plan.boreholes = {hole("B1", 0.1, 0.25), hole("B2", 0.5, 0.25), hole("B3", 0.5, 0.6), hole("B4", 0.1, 0.6)};
    OsteotomyLine outline;
    outline.name = "Outline";
    outline.closed = true;
    for (const Borehole& corner : plan.boreholes) outline.points_in_ct.push_back(corner.position_in_ct);
    plan.osteotomy_lines.push_back(outline);
    const PlanDrawing drawing = drawing_of(plan);
    const CheckLightSettings settings;
    const auto crowded = crowded_segments_of(drawing, segments_of(drawing, settings), settings);
    EXPECT_FALSE(crowded.empty()) << "of the outline, within the holes";
    for (const StrokeSegment& segment : crowded)
        EXPECT_EQ(drawing.items[static_cast<std::size_t>(segment.item)].name, "Outline");
    const LightCheck check =
        check_light(drawing, test::ball(), rig, RigidTransform::Identity(), test::pictures_of(drawing, rig, {}));
    EXPECT_EQ(ruling_of(check).headline, "The plan is on the skin.");
}

/// The cameras see a third of the line; on the rest there is no light at all.
TEST(SkinHeight, ALineOfWhichTheCamerasSeeAThirdIsMeasuredInPartOnly) {
    RigCalibration rig = test::rig_before_ball();
    Plan plan;
    plan.boreholes = {hole("Hole 1", 0.25, 0.7), hole("Hole 2", 0.25, 0.05)};
    OsteotomyLine line;
    line.name = "Line";
    for (double longitude = 0.3; longitude < 1.0; longitude += 0.1)
        line.points_in_ct.push_back(test::on_ball(longitude, 0.4));
    plan.osteotomy_lines.push_back(line);
    const PlanDrawing drawing = drawing_of(plan);
    // Both pictures end to the right of the target's column.
    const Vector3d seen_to = test::on_ball(0.3 + 0.2, 0.4);
    for (CameraModel* camera : {&rig.left_camera, &rig.right_camera})
        camera->width = static_cast<int>(project(*camera, seen_to)->x());
    test::LitBall lit;
    const auto check_of = [&] {
        return check_light(drawing, test::ball(), rig, RigidTransform::Identity(),
                           test::pictures_of(drawing, rig, lit));
    };
    const LightCheck check = check_of();
    const auto cut = std::ranges::find(check.items, "Line", &ItemLight::name);
    ASSERT_NE(cut, check.items.end());
    EXPECT_GT(cut->lit_segments, 2 * cut->segments);
    EXPECT_EQ(cut->seen, cut->segments);
    EXPECT_LT(check.expected, check.lit);
    const LightGate::Ruling ruling = ruling_of(check);
    EXPECT_EQ(ruling.headline, "LOOK: \"Line\" is measured in part only.");
}

}  // namespace
}  // namespace planlight
