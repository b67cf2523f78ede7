#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "planning_io/files/safe_write.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

Plan a_plan() {
    Plan plan;
    plan.trajectories.push_back(
        {"Biopsy α", {0.1, -1.0 / 3, 1e-7}, {12.3456789012345678, 40, -17}, 2.1, Colour{0.1F, 0.2F, 1.0F / 3}});
    plan.trajectories.push_back({"bare", {1, 2, 3}, {4, 5, 6}, 0, std::nullopt});
    plan.boreholes.push_back({"B1", {30.1, -60.2, 70.3}, Vector3d(0.48, -0.6, 0.64), 7, 6.25, std::nullopt});
    plan.boreholes.push_back({"B2", {-30.1, -60.2, 70.3}, std::nullopt, 1.0 / 3, 0, Colour{1, 0, 0}});
    plan.osteotomy_lines.push_back({"flap", {{1, 2, 3}, {4, 5, 6}, {7, 8, 10}, {1, 0, 0.1}}, true, Colour{0, 1, 0}});
    plan.osteotomy_lines.push_back({"cut", {{1, 2, 3}, {4, 5, 6.1}}, false, std::nullopt});
    plan.cut_planes.push_back(
        {"Le Fort", {1, -80, -40.5}, Vector3d(0, 0.6, 0.8), Vector3d(1, 0, 0), 80.5, 40.25, std::nullopt});
    return plan;
}

TEST(PlanFile, ReadsBackValueForValue) {
    const test::TemporaryFolder folder;
    const Plan plan = a_plan();
    write_plan(plan, folder.path() / "plan.mrk.json");
    const Plan back = read_plan(folder.path() / "plan.mrk.json");
    ASSERT_EQ(back.trajectories.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(back.trajectories[i].name, plan.trajectories[i].name);
        EXPECT_EQ(back.trajectories[i].entry_in_ct, plan.trajectories[i].entry_in_ct);
        EXPECT_EQ(back.trajectories[i].target_in_ct, plan.trajectories[i].target_in_ct);
        EXPECT_EQ(back.trajectories[i].diameter_mm, plan.trajectories[i].diameter_mm);
        EXPECT_EQ(back.trajectories[i].colour, plan.trajectories[i].colour);
    }
    ASSERT_EQ(back.boreholes.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(back.boreholes[i].name, plan.boreholes[i].name);
        EXPECT_EQ(back.boreholes[i].position_in_ct, plan.boreholes[i].position_in_ct);
        EXPECT_EQ(back.boreholes[i].axis_in_ct, plan.boreholes[i].axis_in_ct);
        EXPECT_EQ(back.boreholes[i].diameter_mm, plan.boreholes[i].diameter_mm);
        EXPECT_EQ(back.boreholes[i].depth_mm, plan.boreholes[i].depth_mm);
        EXPECT_EQ(back.boreholes[i].colour, plan.boreholes[i].colour);
    }
    ASSERT_EQ(back.osteotomy_lines.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(back.osteotomy_lines[i].points_in_ct, plan.osteotomy_lines[i].points_in_ct);
        EXPECT_EQ(back.osteotomy_lines[i].closed, plan.osteotomy_lines[i].closed);
        EXPECT_EQ(back.osteotomy_lines[i].colour, plan.osteotomy_lines[i].colour);
    }
    ASSERT_EQ(back.cut_planes.size(), 1u);
    EXPECT_EQ(back.cut_planes[0].origin_in_ct, plan.cut_planes[0].origin_in_ct);
    EXPECT_EQ(back.cut_planes[0].normal_in_ct, plan.cut_planes[0].normal_in_ct);
    EXPECT_EQ(back.cut_planes[0].first_axis_in_ct, plan.cut_planes[0].first_axis_in_ct);
    EXPECT_EQ(back.cut_planes[0].width_mm, 80.5);
    EXPECT_EQ(back.cut_planes[0].height_mm, 40.25);
    EXPECT_EQ(points_of(back).size(), 4u + 2 + 6 + 1);
}

/// A file of one markup, in the words of 3D Slicer 5.
std::string line_file(const std::string& system = R"("LPS")", const std::string& units = R"("coordinateUnits": "mm",)",
                      const std::string& entry = "[10, -20, 30]", const std::string& schema = "v1.0.3",
                      const std::string& type = "Line") {
    return R"({"@schema": "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/markups-schema-)" +
           schema + R"(.json#", "markups": [{"type": ")" + type + R"(", "name": "T", "coordinateSystem": )" + system +
           ", " + units + R"( "controlPoints": [{"label": "a", "position": )" + entry +
           R"(, "positionStatus": "defined"}, {"position": [1, 2, 3]}],
           "display": {"color": [0.4, 1, 1], "selectedColor": [1, 0.5, 0.5]}}]})";
}

class PlanText : public ::testing::Test {
protected:
    Plan read(const std::string& text) {
        write_safely(folder_.path() / "p.mrk.json", text);
        return read_plan(folder_.path() / "p.mrk.json");
    }
    test::TemporaryFolder folder_;
};

TEST_F(PlanText, RasIsTurnedHalfwayAboutZAndMicrometresAreThousandths) {
    EXPECT_EQ(read(line_file()).trajectories[0].entry_in_ct, Vector3d(10, -20, 30));
    EXPECT_EQ(read(line_file(R"("RAS")")).trajectories[0].entry_in_ct, Vector3d(-10, 20, 30));
    EXPECT_TRUE(read(line_file(R"("LPS")", R"("coordinateUnits": "um",)", "[10000, -20000, 30000]"))
                    .trajectories[0]
                    .entry_in_ct.isApprox(Vector3d(10, -20, 30), 1e-12));
    EXPECT_EQ(
        read(line_file(R"("LPS")", R"("coordinateUnits": ["mm", "UCUM", "millimeter"],)")).trajectories[0].entry_in_ct,
        Vector3d(10, -20, 30));
    EXPECT_EQ(read(line_file(R"("LPS")", "", "[10, -20, 30]", "v1.0.2")).trajectories[0].entry_in_ct,
              Vector3d(10, -20, 30));
    EXPECT_EQ((*read(line_file()).trajectories[0].colour)[1], 0.5F);
}

TEST_F(PlanText, WhatDoesNotSayItsFrameOrUnitIsRefused) {
    for (const char* system : {R"("lps")", R"("SRA")", R"("")", R"("LPS ")", "null", "0", "1"})
        EXPECT_THROW(read(line_file(system)), InputError) << system;
    for (const char* units : {R"("coordinateUnits": "m",)", R"("coordinateUnits": "cm",)", R"("coordinateUnits": "",)",
                              R"("coordinateUnits": [],)", R"("coordinateUnits": ["in", "UCUM", "inch"],)", ""})
        EXPECT_THROW(read(line_file(R"("LPS")", units)), InputError) << units;
}

TEST_F(PlanText, NonsenseIsRefusedByName) {
    EXPECT_THROW(read(line_file(R"("LPS")", R"("coordinateUnits": "mm",)", "[1, 2, 3]")), InputError) << "no length";
    EXPECT_THROW(read(line_file(R"("LPS")", R"("coordinateUnits": "mm",)", "[1, 2]")), InputError);
    EXPECT_THROW(read(line_file(R"("LPS")", R"("coordinateUnits": "mm",)", "[1, 2, \"3\"]")), InputError);
    EXPECT_THROW(read(line_file(R"("LPS")", R"("coordinateUnits": "mm",)", "[1, 2, 90000]")), InputError);
    EXPECT_ANY_THROW(read(line_file(R"("LPS")", R"("coordinateUnits": "mm",)", "[1, 2, NaN]")));
    EXPECT_ANY_THROW(read(line_file(R"("LPS")", R"("coordinateUnits": "mm",)", "[1, 2, 1e999]")));
    EXPECT_THROW(read(line_file(R"("LPS")", R"("coordinateUnits": "mm",)", "[1, 2, 4]", "v2.0.0")), InputError);
    EXPECT_THROW(read("{\"markups\": []}"), InputError);
    EXPECT_THROW(read(line_file() + "x"), DamagedFileError);
    EXPECT_THROW(read(line_file().substr(0, 200)), DamagedFileError);
    EXPECT_THROW(read(std::string(100000, '[')), Error);
    for (const char* type : {"ROI", "Spiral"}) {
        try {
            read(line_file(R"("LPS")", R"("coordinateUnits": "mm",)", "[1, 2, 4]", "v1.0.3", type));
            FAIL() << type;
        } catch (const InputError& e) {
            EXPECT_NE(std::string(e.what()).find(type), std::string::npos) << e.what();
        }
    }
    std::string unplaced = line_file();
    unplaced.replace(unplaced.find("\"defined\""), 9, "\"preview\"");
    EXPECT_THROW(read(unplaced), InputError);
    std::string twice = line_file();
    twice.insert(twice.find("\"coordinateSystem\""), "\"coordinateSystem\": \"RAS\", ");
    EXPECT_THROW(read(twice), InputError);
}

TEST_F(PlanText, NotFiniteNumbersAreNotWritten) {
    Plan plan = a_plan();
    plan.osteotomy_lines[0].points_in_ct[1].y() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(write_plan(plan, folder_.path() / "plan.mrk.json"), InputError);
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "plan.mrk.json"));
}

TEST_F(PlanText, AFolderOfFilesIsOnePlan) {
    write_safely(folder_.path() / "a.mrk.json", line_file());
    write_safely(folder_.path() / "b.mrk.json", line_file(R"("RAS")"));
    write_safely(folder_.path() / "notes.txt", "not a plan");
    EXPECT_EQ(read_plan(folder_.path()).trajectories.size(), 2u);
    EXPECT_THROW(read_plan(folder_.path() / "none.mrk.json"), InputError);
    const test::TemporaryFolder empty;
    EXPECT_THROW(read_plan(empty.path()), InputError);
}

TEST(PlanThirdParty, MarkupsThatSlicerWroteAreReadAsTheirNumbersStand) {
    const auto file = test::third_party_data("plans/slicermorph_mrkjson_fiducials/A_J.mrk.json");
    if (!file) GTEST_SKIP() << "third-party plans are not here";
    const Plan plan = read_plan(*file);
    ASSERT_GT(plan.boreholes.size(), 10u);
    EXPECT_EQ(plan.boreholes[0].position_in_ct, Vector3d(-9.21016, -25.0792, 9.31477));  // the file's first point, LPS
    EXPECT_FALSE(plan.boreholes[0].axis_in_ct);
}

}  // namespace
}  // namespace planlight
