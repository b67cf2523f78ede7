#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <set>

#include "projection/place_all_labels.h"
#include "projection/render_drawing.h"
#include "tests/projection/shapes.h"
#include "tests/support/analytic_head.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using test::ball;
using test::on_ball;

const CameraModel& projector() {
    static const CameraModel kProjector = test::projector_looking_at({80, 0, 0}, {1, 0, 0}, 560, {0, 0, 1});
    return kProjector;
}
const DrawingRenderer& renderer() {
    static const DrawingRenderer kRenderer(ball(), projector());
    return kRenderer;
}

Plan plan_of_three() {
    Plan plan;
    plan.osteotomy_lines.push_back({"Osteotomy", {on_ball(-0.4, 0.35), on_ball(0.4, 0.35)}, false, {}});
    plan.boreholes.push_back({"B1", on_ball(-0.2, -0.1), {}, 7, 6, {}});
    plan.cut_planes.push_back({"C1", {80, 0, -30}, Vector3d::UnitZ(), Vector3d::UnitY(), 60, 60, {}});
    return plan;
}

/// How bright the picture is in all.
double light_of(const RgbImage& picture) {
    double sum = 0;
    for (const Rgb& p : picture.pixels)
        for (const std::uint8_t number : p)
            if (number > 0) sum += test::light_of_number(number);
    return sum;
}

/// The drawing's labels alone.
PlanDrawing labels_of(PlanDrawing drawing) {
    drawing.strokes.clear();
    return drawing;
}

TEST(LabelsInLight, ALabelIsLitWholeOrNotAtAllWhereverTheHeadIs) {
    const PlanDrawing drawing = labels_of(draw_plan(plan_of_three(), ball()));
    for (std::size_t which = 0; which < 3; ++which) {
        int whole = 0, none = 0;
        RenderSettings alone;
        alone.only_item = static_cast<int>(which);
        for (double aside_mm = -240; aside_mm <= 240; aside_mm += 6)
            for (const double turn : {0.0, 0.5, 1.0}) {
                const RigidTransform pose =
                    Eigen::Translation3d(0, aside_mm, 0.4 * aside_mm) * Eigen::AngleAxisd(turn, Vector3d::UnitZ());
                RgbImage picture;
                const RenderCounts counts = renderer().render_into(picture, drawing, pose, pose, alone);
                ASSERT_EQ(counts.labels_lit.size() + counts.labels_left_out.size(), 1u);
                if (counts.labels_lit.empty()) {
                    ++none;
                    ASSERT_EQ(light_of(picture), 0);
                    continue;
                }
                ++whole;
                const auto label = std::find_if(drawing.labels.begin(), drawing.labels.end(), [&](const Label& l) {
                    return l.item == static_cast<int>(which) && !l.of_moment;
                });
                for (const auto& sign : label->signs_in_ct)
                    for (const auto& outline : sign)
                        for (const Vector3d& p : outline) {
                            const auto pixel = project(projector(), pose * p);
                            ASSERT_TRUE(pixel && in_picture(projector(), *pixel));
                            const Vector3d to_light = projector().centre_in_rig() - pose * p;
                            ASSERT_GT((pose.linear() * p.normalized()).dot(to_light.normalized()), std::cos(1.16));
                        }
            }
        EXPECT_GT(whole, 10);
        EXPECT_GT(none, 10);
    }
}

/// The distance of a card's field to the nearest point of a stroke.
double from_strokes_mm(const Label& card, const PlanDrawing& drawing) {
    double nearest = 1e9;
    for (const Stroke& stroke : drawing.strokes)
        for (const Vector3d& p : stroke.points_in_ct)
            for (const Vector3d& q : card.field_in_ct) nearest = std::min(nearest, (p - q).norm());
    return nearest;
}

TEST(LabelsInLight, TheCardNamesThePatientApartFromThePlanAndIsLitOnlyWhenAskedFor) {
    DrawingSettings settings;
    settings.light = LightView{projector(), RigidTransform::Identity()};
    const PlanDrawing without = draw_plan(plan_of_three(), ball(), settings);
    EXPECT_FALSE(without.card);
    settings.card = {"Mustermann, Erika", "RIGHT"};
    for (const Vector3d& up : {Vector3d(0, 0, 1), Vector3d(0, 0, -1), Vector3d(0, 1, 0)}) {
        settings.up_in_ct = up;
        const PlanDrawing drawing = draw_plan(plan_of_three(), ball(), settings);
        ASSERT_TRUE(drawing.card);
        EXPECT_EQ(drawing.card->words, "Mustermann,\nErika\nRIGHT");
        EXPECT_GT(from_strokes_mm(*drawing.card, drawing), 2) << "a line beside it could be taken for a letter";
        for (const Label& label : drawing.labels) {
            if (label.of_moment) continue;
            for (const Vector3d& p : label.field_in_ct)
                for (const Vector3d& q : drawing.card->field_in_ct) ASSERT_GT((p - q).norm(), 3);
        }
        // Upright for the viewer: its first line stands above its last.
        const auto middle = [](const Label::Outlines& sign) { return sign.front().front(); };
        EXPECT_GT((middle(drawing.card->signs_in_ct.front()) - middle(drawing.card->signs_in_ct.back())).dot(up), 5);
        RenderSettings render;
        RgbImage dark, lit;
        const RigidTransform here = RigidTransform::Identity();
        EXPECT_FALSE(renderer().render_into(dark, drawing, here, here, render).card_lit);
        render.card = true;
        EXPECT_TRUE(renderer().render_into(lit, drawing, here, here, render).card_lit);
        EXPECT_GT(light_of(lit), light_of(dark));
        render.item_of_moment = 1;
        EXPECT_FALSE(renderer().render_into(lit, drawing, here, here, render).card_lit) << "that one has the light";
        render.item_of_moment = -1;
        render.keep_dark_in_patient = {drawing.card->field_in_ct.front()};
        EXPECT_FALSE(renderer().render_into(lit, drawing, here, here, render).card_lit) << "whole, or not at all";
    }
}

TEST(LabelsInLight, AMarkerThatWouldDarkenAPartOfALabelDarkensAllOfIt) {
    const PlanDrawing drawing = labels_of(draw_plan(plan_of_three(), ball()));
    RenderSettings settings;
    RgbImage picture;
    ASSERT_EQ(renderer().render_into(picture, drawing, RigidTransform::Identity()).labels_lit.size(), 3u);
    settings.keep_dark_in_patient = {drawing.labels[0].field_in_ct.front()};
    const auto counts =
        renderer().render_into(picture, drawing, RigidTransform::Identity(), RigidTransform::Identity(), settings);
    EXPECT_EQ(counts.labels_left_out, std::vector<int>{drawing.labels[0].item});
    EXPECT_NE(
        sentence_of_labels(counts, drawing).find(drawing.items[static_cast<std::size_t>(drawing.labels[0].item)].name),
        std::string::npos);
}

TEST(LabelsInLight, WhereTheLightIsKnownLabelsArePutWhereAllOfThemIsLit) {
    Plan plan;  // at the rim of what is lit: to one side of each hole the ball turns away
    for (const double longitude : {-0.95, -0.5, 0.5, 0.95})
        plan.boreholes.push_back({"Hole at the rim", on_ball(longitude, 0.1), {}, 7, 6, {}});
    DrawingSettings settings;
    settings.light = LightView{projector(), RigidTransform::Identity()};
    RgbImage picture;
    const auto counts = renderer().render_into(picture, draw_plan(plan, ball(), settings), RigidTransform::Identity());
    EXPECT_EQ(counts.labels_lit.size(), 4u);
    EXPECT_TRUE(counts.labels_left_out.empty());
}

TEST(LabelsInLight, TheItemOfTheMomentIsBrightTheRestDimOrHidden) {
    const PlanDrawing drawing = draw_plan(plan_of_three(), ball());
    const auto light_of_item = [&](int item, int of_moment, double others) {
        RenderSettings settings;
        settings.only_item = item;
        settings.item_of_moment = of_moment;
        settings.others = others;
        return light_of(renderer().render(drawing, RigidTransform::Identity(), RigidTransform::Identity(), settings));
    };
    PlanDrawing lines = drawing;
    lines.labels.clear();
    RenderSettings alone;
    alone.only_item = 0;
    const double lines_alone =
        light_of(renderer().render(lines, RigidTransform::Identity(), RigidTransform::Identity(), alone));
    EXPECT_NEAR(light_of_item(0, 1, 0.25), 0.25 * lines_alone, 0.02 * lines_alone) << "dim, and without its label";
    EXPECT_EQ(light_of_item(0, 1, 0), 0);
    EXPECT_NEAR(light_of_item(1, 1, 0.25), light_of_item(1, -1, 0.25), 0.05 * light_of_item(1, -1, 0.25))
        << "as bright as ever, with its label";
}

TEST(LabelsInLight, ACutPlaneIsDashedBetweenItsTicksAndAnOsteotomyLineIsNot) {
    for (const int item : {0, 2}) {
        PlanDrawing drawing = draw_plan(plan_of_three(), ball());
        drawing.labels.clear();
        std::erase_if(drawing.strokes, [&](const Stroke& s) { return s.item != item || s.kind == StrokeKind::tick; });
        ASSERT_EQ(drawing.strokes.size(), 1u);
        const RgbImage picture = renderer().render(drawing, RigidTransform::Identity());
        const auto& points = drawing.strokes[0].points_in_ct;
        double way_mm = 0;
        int lit = 0, dark = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (i > 0) way_mm += (points[i] - points[i - 1]).norm();
            const auto pixel = project(projector(), points[i]);
            ASSERT_TRUE(pixel);
            const Rgb& p =
                picture.at(static_cast<int>(std::lround(pixel->x())), static_cast<int>(std::lround(pixel->y())));
            const bool is_lit = std::max({p[0], p[1], p[2]}) > 100;
            const double from_tick_mm = std::abs(std::remainder(way_mm, 10));
            ++(is_lit ? lit : dark);
            if (from_tick_mm > 2) {
                EXPECT_TRUE(is_lit) << item << " at " << way_mm;
            }
            if (item == 2 && way_mm > 5 && from_tick_mm < 0.5) {
                EXPECT_FALSE(is_lit) << "at " << way_mm;
            }
        }
        if (item == 0) {
            EXPECT_LE(dark, 2) << "the two ends";
        }
        if (item == 2) {
            EXPECT_GT(dark, 10);
        }
    }
}

TEST(LabelsInLight, FortyItemsHaveNamesOrCodesThatOverlapNothingAndNoMoreTextThanMayBe) {
    Plan plan;
    for (int i = 0; i < 40; ++i)
        plan.boreholes.push_back(
            {"Bohrung " + std::to_string(i + 1), on_ball(-0.75 + 0.2 * (i % 8), -0.5 + 0.25 * (i / 8)), {}, 4, 6, {}});
    DrawingSettings settings;
    settings.light = LightView{projector(), RigidTransform::Identity()};
    const PlanDrawing drawing = draw_plan(plan, ball(), settings);
    EXPECT_LE(share_of_text(drawing), settings.most_text);
    int of_moment = 0;
    for (const Label& label : drawing.labels) of_moment += label.of_moment;
    // What is drawn together: no place of a label's field lies on another's or on what is drawn.
    OccupiedSkin taken;
    for (const Stroke& stroke : drawing.strokes)
        for (const Vector3d& p : stroke.points_in_ct) taken.add(p);
    for (const Label& label : drawing.labels)
        if (!label.of_moment)
            for (const Vector3d& p : label.field_in_ct) taken.add(p, label.item);
    int named = 0, by_code = 0;
    for (const Label& label : drawing.labels) {
        if (label.of_moment) continue;
        for (const Vector3d& p : label.field_in_ct)
            ASSERT_FALSE(taken.within(p, 0.5, label.item)) << label.words << " lies over something";
        const DrawnItem& item = drawing.items[static_cast<std::size_t>(label.item)];
        (label.by_code ? by_code : named) += 1;
        EXPECT_EQ(label.words.substr(0, (label.by_code ? item.code : item.name).size()),
                  label.by_code ? item.code : item.name);
    }
    RecordProperty("named", named), RecordProperty("by_code", by_code);
    EXPECT_GE(named + by_code, 24) << named << " names and " << by_code << " codes of 40 items";
    EXPECT_GE(named, 1);
    EXPECT_GE(of_moment, 36) << "nearly every item has a label for when it is the item of the moment";
    RgbImage picture = renderer().render(drawing, RigidTransform::Identity());
    test::keep_picture(picture, "forty_items.png");
    RenderSettings moment;
    moment.item_of_moment = 20;
    picture = renderer().render(drawing, RigidTransform::Identity(), RigidTransform::Identity(), moment);
    test::keep_picture(picture, "forty_items_one_of_moment.png");
}

/// Each item's label.
std::map<int, Label> label_of_each(const PlanDrawing& drawing) {
    std::map<int, Label> labels;
    for (const Label& label : drawing.labels)
        if (!label.of_moment) labels[label.item] = label;
    return labels;
}

TEST(LabelsInLight, LettersAreLargerWhereThereIsRoomAndThatCostsNoOtherWords) {
    for (const auto& [holes, diameter_mm] : {std::pair(1, 20.), std::pair(6, 8.), std::pair(40, 4.)}) {
        Plan plan;
        for (int i = 0; i < holes; ++i)
            plan.boreholes.push_back({"Bohrung " + std::to_string(i + 1),
                                      on_ball(-0.75 + 0.2 * (i % 8), -0.5 + 0.25 * (i / 8)),
                                      {},
                                      diameter_mm,
                                      6,
                                      {}});
        DrawingSettings settings;
        settings.light = LightView{projector(), RigidTransform::Identity()};
        const auto lit = label_of_each(draw_plan(plan, ball(), settings));
        settings.largest_text_mm = settings.text_height_mm;
        const auto of_one_height = label_of_each(draw_plan(plan, ball(), settings));
        ASSERT_EQ(lit.size(), of_one_height.size()) << holes;
        double smallest_mm = 1e9, largest_mm = 0;
        for (const auto& [item, label] : lit) {
            EXPECT_EQ(label.words, of_one_height.at(item).words);
            EXPECT_EQ(of_one_height.at(item).text_height_mm, 5);
            EXPECT_LE(label.gap_mm, of_one_height.at(item).gap_mm) << label.words;
            smallest_mm = std::min(smallest_mm, label.text_height_mm);
            largest_mm = std::max(largest_mm, label.text_height_mm);
        }
        EXPECT_GT(largest_mm, 5) << holes;
        if (holes == 1) {
            EXPECT_GE(smallest_mm, 6) << "all the ball is free";
        }
        if (holes == 40) {
            EXPECT_EQ(smallest_mm, 5) << "else this plan is not crowded enough to tell";
        }
    }
}

TEST(LabelsInLight, ANameThatCannotBeDrawnHasItsCodeAndTheFiguresStay) {
    Plan plan;
    plan.boreholes.push_back({"\U0010FFFD", on_ball(0, 0), {}, 7, 6, {}});
    const PlanDrawing drawing = draw_plan(plan, ball());
    ASSERT_FALSE(drawing.labels.empty());
    EXPECT_EQ(drawing.labels[0].words, "#1\n7 mm wide\n6 mm deep");
    EXPECT_EQ(drawing.items[0].name, "\U0010FFFD");
    EXPECT_EQ(drawing.items[0].code, "#1");
    EXPECT_TRUE(drawing.items[0].lit_by_code);
    ASSERT_EQ(drawing.items[0].warnings.size(), 1u);
}

// Whether by its signs or by want of room: a code that names another item is never lit.
TEST(LabelsInLight, ACodeOfACrowdedPlanIsNobodysNameAndIsTold) {
    Plan plan;
    plan.osteotomy_lines.push_back({"Osteotomy", {on_ball(-0.4, 0.5), on_ball(0.4, 0.5)}, false, {}});
    for (int i = 0; i < 12; ++i)
        plan.boreholes.push_back({"Bohrung unten links " + std::to_string(i + 1),
                                  on_ball(-0.3 + 0.15 * (i % 4), -0.3 + 0.15 * (i / 4)),
                                  {},
                                  4,
                                  6,
                                  {}});
    DrawingSettings settings;
    settings.light = LightView{projector(), RigidTransform::Identity()};
    const PlanDrawing drawing = draw_plan(plan, ball(), settings);
    int by_code = 0;
    std::set<std::string> first_lines;
    for (const Label& label : drawing.labels) {
        if (label.of_moment) continue;
        const DrawnItem& item = drawing.items[static_cast<std::size_t>(label.item)];
        EXPECT_EQ(item.lit_by_code, label.by_code) << item.name;
        if (!label.by_code) continue;
        ++by_code;
        EXPECT_EQ(item.lit_name, item.code);
        EXPECT_EQ(label.words.substr(0, label.words.find('\n')), item.code);
        EXPECT_EQ(item.code.find_first_of("0123456789"), std::string::npos) << item.code << " for " << item.name;
        EXPECT_TRUE(first_lines.insert(item.code).second) << item.code << " is lit twice";
    }
    EXPECT_GE(by_code, 2) << "else this plan is not crowded enough to tell";
}

}  // namespace
}  // namespace planlight
