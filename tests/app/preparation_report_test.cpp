#include <gtest/gtest.h>

#include <numbers>

#include "app/report/plan_facts.h"
#include "app/report/removed_pieces.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

TEST(PlanFacts, ADistanceIsAsGraveAsItIsSaidToBe) {
    EXPECT_EQ(distance_in_words(0), "on the skin");
    EXPECT_EQ(distance_in_words(0.4), "on the skin");
    EXPECT_EQ(gravity_of(0), Gravity::none);
    EXPECT_EQ(distance_in_words(1.2), "1.2 mm off the skin");
    EXPECT_EQ(gravity_of(1.2), Gravity::none);
    EXPECT_EQ(gravity_of(4), Gravity::look);
    EXPECT_NE(distance_in_words(14).find("far"), std::string::npos);
    EXPECT_EQ(gravity_of(31), Gravity::stop);
    EXPECT_NE(distance_in_words(31).find("not drawn"), std::string::npos);
    EXPECT_EQ(gravity_of(NAN), Gravity::stop);
}

TEST(PlanFacts, DirectionsAreThoseOfThePatient) {
    // ct is LPS: +x to the patient's left, +y backwards, +z up.
    const double half = std::sqrt(0.5);
    EXPECT_EQ(direction_in_words({0, 1, 0}), "straight back");
    EXPECT_EQ(direction_in_words({half, half, 0}), "45° to the left");
    EXPECT_EQ(direction_in_words({-0.5, std::sqrt(0.5), -0.5}), "30° to the right, 30° down");
}

/// A skin of one plane, facing anterior, 5 mm over bone.
SkinLut flat_skin() {
    SkinLut lut;
    lut.size = {2, 2, 2};
    lut.voxel_mm = 100;
    lut.nearest.assign(8, 0);
    lut.skin.push_back({Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(0, -1, 0), {0, 0, 0}, 0, 5.0F});
    return lut;
}

TEST(PlanFacts, DepthAndAngleAreThoseOfThePlan) {
    Plan plan;
    plan.boreholes.push_back({"B", Vector3d(0, 0, 0), std::nullopt, 7, 6, std::nullopt});
    plan.trajectories.push_back({"T", Vector3d(0, 0, 0), Vector3d(30, 40, 0), 2, std::nullopt});
    PlanDrawing drawing;
    drawing.items = {{StrokeKind::borehole, "B", "B", Vector3d(0, 0, 0), 0, {}, true, {}, {}},
                     {StrokeKind::trajectory, "T", "T", Vector3d(0, 0, 0), 3, {}, true, {}, {}}};
    const auto facts = plan_facts(plan, drawing, flat_skin());
    ASSERT_EQ(facts.size(), 2U);
    EXPECT_EQ(*facts[0].tilt, 0);
    EXPECT_EQ(*facts[0].depth_mm, 6);
    EXPECT_EQ(*facts[0].over_bone_mm, 5);
    EXPECT_NEAR(*facts[1].depth_mm, 50, 1e-9);
    EXPECT_NEAR(*facts[1].tilt, std::atan2(3, 4), 1e-6);
    EXPECT_EQ(facts[1].gravity, Gravity::look);
    EXPECT_FALSE(facts[0].left_of_middle_mm) << "no mid-plane was found";
    const auto sided = plan_facts(plan, drawing, flat_skin(), MidPlane{Vector3d(12, 0, 0), Vector3d(1, 0, 0)});
    EXPECT_NEAR(*sided[0].left_of_middle_mm, -12, 1e-9) << "LPS: +x is the patient's left";
    EXPECT_EQ(side_in_words(*sided[0].left_of_middle_mm), "12 mm right");
    EXPECT_EQ(side_in_words(1.4), "in the middle");
}

TEST(PlanFacts, OnlyWhatGoesThroughAStructureStopsAndAllThatWarnsIsNamed) {
    EXPECT_EQ(gravity_of(Clearances{}), Gravity::none);
    EXPECT_EQ(risk_in_words({}), "–");
    const Clearance nerve{"Facial nerve", 4.19, false}, near{"Sinus", 0.04, false}, dura{"Dura", 0, true};
    EXPECT_EQ(gravity_of(Clearances{nerve}), Gravity::none);
    EXPECT_EQ(risk_in_words({nerve}), "4.1 mm to Facial nerve");
    EXPECT_EQ(gravity_of(Clearances{near, nerve}), Gravity::look) << "a tenth is not through";
    EXPECT_EQ(risk_in_words({near, nerve}), "0.0 mm to Sinus: near");
    EXPECT_EQ(gravity_of(Clearances{dura, near, nerve}), Gravity::stop);
    EXPECT_EQ(risk_in_words({dura, near, nerve}), "through Dura; 0.0 mm to Sinus");
}

TEST(PlanFacts, AnItemThatTheLightNamesOtherwiseHasThatName) {
    Plan plan;
    for (const char* name : {"Hole", "Long name of a hole", "Loch"})
        plan.boreholes.push_back({name, Vector3d(0, 0, 0), std::nullopt, 7, 6, std::nullopt});
    PlanDrawing drawing;
    drawing.items = {
        {StrokeKind::borehole, "Hole", "Hole", Vector3d(0, 0, 0), 0, {}, true, "Hole", "#1", false},
        {StrokeKind::borehole, "Long name of a hole", "", Vector3d(0, 0, 0), 0, {}, true, "#2", "#2", true},
        {StrokeKind::borehole, "Loch", "", Vector3d(0, 0, 0), 0, {}, false, "", "#3", false}};
    const auto facts = plan_facts(plan, drawing, flat_skin());
    EXPECT_EQ(facts[0].lit, "");
    EXPECT_EQ(facts[1].lit, "#2");
    EXPECT_EQ(facts[2].lit, "") << "nothing of it is lit";
}

/// 100 mm of air with a ball of 30 mm in the middle, and a plate of 40 x 4 x 40 mm behind it. Voxels of 2 mm.
Volume ball_and_plate(SkinMask& mask) {
    Volume v;
    v.size = {51, 51, 51};
    v.ct_from_voxel.linear() = 2 * Eigen::Matrix3d::Identity();
    v.ct_from_voxel.translation() = Vector3d(-50, -50, -50);
    v.values.assign(51 * 51 * 51, -1000);
    mask.body.assign(v.values.size(), 0);
    mask.threshold = -300;
    for (int k = 0; k < 51; ++k)
        for (int j = 0; j < 51; ++j)
            for (int i = 0; i < 51; ++i) {
                const Vector3d p = v.ct_from_voxel * Vector3d(i, j, k);
                const bool ball = p.norm() < 30,
                           plate = std::abs(p.x()) < 20 && std::abs(p.z()) < 20 && std::abs(p.y() - 40) < 2;
                if (ball || plate) v.values[v.index(i, j, k)] = 50;
                mask.body[v.index(i, j, k)] = ball;
            }
    return v;
}

TEST(RemovedPieces, APlateBehindTheHeadIsFoundWithItsVolumeAndPlace) {
    SkinMask mask;
    const Volume volume = ball_and_plate(mask);
    const RemovedPieces removed = find_removed_pieces(volume, mask);
    ASSERT_EQ(removed.pieces.size(), 1U);
    EXPECT_NEAR(removed.pieces[0].ml, 19 * 1 * 19 * 0.008, 1e-9) << "19 x 1 x 19 voxels of 8 cubic mm";
    EXPECT_LT((removed.pieces[0].middle_in_ct - Vector3d(0, 40, 0)).norm(), 1e-9);
    EXPECT_EQ(place_in_words(removed.pieces[0].middle_in_ct, removed.body_middle_in_ct), "40 mm behind");
    ASSERT_EQ(removed.pictures.size(), 2U);
    // From the left the plate is red on the right side of the picture (posterior), and nowhere on the left.
    const RgbImage& left = removed.pictures[1].picture;
    int red_before = 0, red_behind = 0;
    for (int y = 0; y < left.height; ++y)
        for (int x = 0; x < left.width; ++x)
            if (left.at(x, y)[0] > 180 && left.at(x, y)[1] < 110) ++(x < left.width / 2 ? red_before : red_behind);
    EXPECT_GT(red_behind, 500);
    EXPECT_EQ(red_before, 0);
}

TEST(RemovedPieces, WhereNothingWasThrownAwayThereIsNothingToShow) {
    SkinMask mask;
    Volume volume = ball_and_plate(mask);
    for (std::size_t v = 0; v < mask.body.size(); ++v)
        if (!mask.body[v]) volume.values[v] = -1000;
    const RemovedPieces removed = find_removed_pieces(volume, mask);
    EXPECT_TRUE(removed.pieces.empty());
    EXPECT_TRUE(removed.pictures.empty());
}

TEST(RemovedPieces, PlacesAreWordsOfThePatient) {
    EXPECT_EQ(place_in_words({0, -95, 0}, {0, 0, 0}), "95 mm in front");
    EXPECT_EQ(place_in_words({40, 0, -60}, {0, 0, 0}), "60 mm below, 40 mm to the left");
    EXPECT_EQ(place_in_words({-40, 5, 3}, {0, 0, 0}), "40 mm to the right");
    EXPECT_EQ(place_in_words({1, 2, 3}, {0, 0, 0}), "at the middle");
}

}  // namespace
}  // namespace planlight::test
