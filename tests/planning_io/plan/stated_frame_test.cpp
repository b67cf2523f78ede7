// What a plan's file says of its frame and unit, in whatever words.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "tests/planning_io/plan/plan_files.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using test::kLps, test::kRas, test::fcsv;

class StatedFrame : public test::PlanFiles {};

const std::string kTable = "name,ex,ey,ez,tx,ty,tz\nA,10,20,30,10,20,-5\n";

TEST_F(StatedFrame, AFrameSaidInOtherWordsIsBelieved) {
    const auto entry = [&](const std::string& name, const std::string& content, const PlanImportSettings& said = {}) {
        const Plan plan = import_plan(write(name, content), said).plan;
        return plan.trajectories.empty() ? plan.boreholes.at(0).position_in_ct : plan.trajectories[0].entry_in_ct;
    };
    for (const char* words :
         {"# Coordinate system: RAS", "# space=RAS", "# SPACE = RAS", "# SPACE: RAS", "# CoordinateSystem = RAS",
          "# Frame: RAS", "#frame:ras", "# coordinate_system = \"RAS\"", "# space: right-anterior-superior",
          "# Coordinates: RAS, mm", "# Exported 2024-03-01 12:30, orientation: RAS+", "# Frame: RAS,,,,,,"}) {
        const std::string table = words + ("\n" + kTable);
        EXPECT_EQ(entry("t.csv", table), Vector3d(-10, -20, 30)) << words;
        EXPECT_EQ(entry("t.csv", table, kRas), Vector3d(-10, -20, 30)) << words;
        EXPECT_SAYS(refusal("t.csv", table, kLps), "says that it is in RAS");
    }
    for (const char* column : {"frame", "Space", "coordinate system", "coord_system"}) {
        const std::string table =
            fmt::format("name,ex,ey,ez,tx,ty,tz,{}\nA,10,20,30,10,20,-5,RAS\nB,1,2,3,1,2,9,RAS\n", column);
        EXPECT_EQ(entry("t.csv", table), Vector3d(-10, -20, 30)) << column;
        EXPECT_TRUE(import_plan(write("t.csv", table)).notes.empty()) << column;
        EXPECT_SAYS(refusal("t.csv", table, kLps), "says that it is in RAS");
    }
    EXPECT_SAYS(refusal("t.csv", "name,ex,ey,ez,tx,ty,tz,frame\nA,10,20,30,10,20,-5,RAS\nB,1,2,3,1,2,9,LPS\n"),
                "below its first row");
    EXPECT_SAYS(refusal("t.csv", "# Frame: LPS\n# Space: RAS\n" + kTable), "both");
    EXPECT_SAYS(refusal("t.csv", "# SPACE=LPS\n" + kTable + "# frame: RAS\n"), "both");
    const std::string row = "id_0,10,20,30,0,0,0,1,1,1,0,P1,,\n";
    for (const char* words : {"# coordinateSystem = RAS", "# CoordinateSystem: RAS", "# Coordinate System = 0",
                              "# CoordinateSystem = ras", "# space: RAS"}) {
        const std::string points = fcsv("4.11", "", std::string(words) + "\n" + row);
        EXPECT_EQ(entry("a.fcsv", points), Vector3d(-10, -20, 30)) << words;
        EXPECT_SAYS(refusal("a.fcsv", points, kLps), "says that it is in RAS");
    }
    EXPECT_SAYS(refusal("a.fcsv", fcsv("4.11", "LPS", "# frame: RAS\n" + row)), "both");
}

TEST_F(StatedFrame, AFrameThatIsNoneOfOursOrContradictsThePersonIsRefused) {
    for (const char* words : {"# Coordinate system: LAS", "# space: left-anterior-superior", "# Frame: SPL",
                              "# CoordinateSystem: IJK", "# space = MNI152"})
        EXPECT_SAYS(refusal("t.csv", words + ("\n" + kTable), kLps), "neither LPS nor RAS");
    for (const char* words : {"# RAS", "# all points in RAS", "# exported from Slicer (RAS), 3 trajectories"}) {
        EXPECT_SAYS(refusal("t.csv", words + ("\n" + kTable), kLps), "--frame says LPS");
        EXPECT_TRUE(refusal("t.csv", words + ("\n" + kTable), kRas).empty()) << words;
        EXPECT_SAYS(refusal("t.csv", words + ("\n" + kTable)), "does not say its coordinate system");
        EXPECT_TRUE(refusal("t.csv", words + ("\n# SPACE=LPS\n" + kTable), kLps).empty()) << words;
    }
    EXPECT_SAYS(refusal("t.csv", kTable + "# RAS\n", kLps), "--frame says LPS");
    const auto vtk = [](const std::string& title) {
        return "# vtk DataFile Version 3.0\n" + title +
               "\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n0 0 0 10 0 0\nLINES 1 3\n2 0 1\n";
    };
    EXPECT_SAYS(refusal("l.vtk", vtk("vtk output RAS"), kLps), "--frame says LPS");
    EXPECT_TRUE(refusal("l.vtk", vtk("vtk output RAS"), kRas).empty());
    EXPECT_TRUE(refusal("l.vtk", vtk("vtk output, space: RAS")).empty());
    EXPECT_SAYS(refusal("l.obj", "# RAS\nv 0 0 0\nv 9 0 0\nl 1 2\n", kLps), "--frame says LPS");
}

TEST_F(StatedFrame, AUnitSaidInOtherWordsIsBelieved) {
    for (const char* words : {"# units: cm", "# Unit = cm", "# UNITS=inch", "# length unit: m", "# units: \"cm\""})
        EXPECT_SAYS(refusal("t.csv", words + ("\n" + kTable), kLps), "neither mm nor um");
    for (const char* words : {"# all coordinates in cm", "# Points [cm]", "# values (inches)"}) {
        EXPECT_SAYS(refusal("t.csv", words + ("\n" + kTable), kLps), "seems to be in");
        EXPECT_TRUE(refusal("t.csv", words + ("\n# units=mm\n" + kTable), kLps).empty()) << words;
    }
    for (const char* words : {"# units: mm", "# Unit = millimetres", "# UNITS = mm"})
        EXPECT_TRUE(refusal("t.csv", words + ("\n" + kTable), kLps).empty()) << words;
    EXPECT_TRUE(import_plan(write("t.csv", "# Units: um\nname,ex,ey,ez,tx,ty,tz\nA,10000,20000,30000,1,2,3\n"), kLps)
                    .plan.trajectories.at(0)
                    .entry_in_ct.isApprox(Vector3d(10, 20, 30), 1e-12));
    EXPECT_SAYS(refusal("t.csv", "name,ex,ey,ez,tx,ty,tz,unit\nA,10,20,30,10,20,-5,cm\n", kLps), "units=cm");
    EXPECT_SAYS(refusal("l.obj", "# File units = meters\nv 0 0 0\nv 9 0 0\nl 1 2\n", kLps), "units=meters");
    EXPECT_SAYS(refusal("a.fcsv", fcsv("4.11", "0", "# units: cm\nid_0,10,20,30,0,0,0,1,1,1,0,P1,,\n")), "units=cm");
}

TEST_F(StatedFrame, OrdinaryWordsSayNeitherFrameNorUnit) {
    for (const char* words :
         {"# 10 cm incision planned", "# Incision length in cm: 10", "# sternocleidomastoid", "# Surgeon: M",
          "# planned by M. Ras, OR 3", "# Unit: M 3", "# unit: m Neuro", "# Frame: Leksell G", "# Frame: 3",
          "# orientation: supine", "# Space: frontal", "# WORKSPACE: OR 3", "# points 3 cm behind the suture",
          "# System: LARS", "# Klinik am Ras Tor", "# time frame: 3 weeks", "# Unit: neurosurgery", "# valid in M 4",
          "# Coordinate system: see below"})
        EXPECT_EQ(refusal("t.csv", words + ("\n" + kTable), kLps), "") << words;
    EXPECT_EQ(
        refusal("t.csv", "name,ex,ey,ez,tx,ty,tz,unit,frame,remark\nm,10,20,30,10,20,-5,Neuro 3,Leksell,in cm\n", kLps),
        "");
    EXPECT_EQ(refusal("t.csv", "name,ex,ey,ez,tx,ty,tz\nRAS,10,20,30,10,20,-5\ncm,10,20,30,10,20,-5\n", kLps), "");
}

TEST_F(StatedFrame, InAFolderThePersonSpeaksForTheFilesThatAreSilent) {
    const std::string markup =
        R"({"@schema": "markups-schema-v1.0.3.json#", "markups": [{"type": "Fiducial", "coordinateSystem": "LPS", )"
        R"("coordinateUnits": "mm", "controlPoints": [{"label": "B", "position": [10, 20, 30]}]}]})";
    write("a.mrk.json", markup);
    const fs::path table = write("b.csv", kTable);
    const PlanImport read = import_plan(folder_.path(), kRas);
    EXPECT_EQ(read.plan.boreholes.at(0).position_in_ct, Vector3d(10, 20, 30));
    EXPECT_EQ(read.plan.trajectories.at(0).entry_in_ct, Vector3d(-10, -20, 30));
    ASSERT_EQ(read.notes.size(), 1U);
    EXPECT_SAYS(read.notes[0], "a.mrk.json says that it is in LPS");
    EXPECT_EQ(read.said_frame.space, Space::ras);
    EXPECT_EQ(read.said_frame.items.trajectories.size(), 1U);
    EXPECT_TRUE(read.said_frame.items.boreholes.empty());
    EXPECT_SAYS(refusal("a.mrk.json", markup, kRas), "--frame says otherwise");  // by itself
    fs::remove(table);
    write("c.mrk.json", R"({"@schema": "markups-schema-v1.0.3.json#", "markups": [{"type": "Fiducial", )"
                        R"("coordinateSystem": "LPS", "coordinateUnits": "mm", "controlPoints": [{"label": "C", )"
                        R"("position": [40, 20, 30]}]}]})");
    EXPECT_THROW(import_plan(folder_.path(), kRas), InputError);  // nobody whom --frame is for
    EXPECT_EQ(import_plan(folder_.path(), kLps).notes.size(), 0U);
}

}  // namespace
}  // namespace planlight
