#include <gtest/gtest.h>

#include <fmt/format.h>

#include <functional>

#include "planning_io/files/safe_write.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/plan/plan_import.h"
#include "planning_io/plan/plan_shapes.h"
#include "planning_io/types/error.h"
#include "tests/planning_io/plan/plan_files.h"
#include "tests/planning_io/plan_facts.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

const fs::path kData = fs::path(PLANLIGHT_SOURCE_DIR) / "tests" / "data" / "plans";
using test::kLps, test::kRas, test::fcsv;

class PlanImportTest : public test::PlanFiles {};

TEST(PlanRoundTrip, AThousandRandomPlansComeBackFromMarkupsBitForBit) {
    const test::TemporaryFolder folder;
    for (unsigned seed = 1; seed <= 1000; ++seed) {
        const Plan plan = test::random_plan(seed);
        write_plan(plan, folder.path() / "plan.mrk.json");
        test::expect_same(plan, read_plan(folder.path() / "plan.mrk.json"));
        if (HasFailure()) FAIL() << "seed " << seed;
    }
}

TEST(PlanRoundTrip, RandomPlansComeBackFromVtp) {
    const test::TemporaryFolder folder;
    for (unsigned seed = 1; seed <= 40; ++seed) {
        const Plan plan = test::random_plan(seed);
        write_plan_vtp(plan, folder.path() / "plan.vtp");
        // Planes are written as their corners, everything else exactly.
        test::expect_same(plan, import_plan(folder.path() / "plan.vtp").plan, plan.cut_planes.empty() ? 0 : 1e-10);
        if (HasFailure()) FAIL() << "seed " << seed;
    }
}

TEST_F(PlanImportTest, FcsvPointsStandWhereSlicerPutsThem) {
    const std::string row = "id_0,10,20,30,0,0,0,1,1,1,0,P1,diameter_mm=7 depth_mm=6.5,\n";
    for (const char* ras : {"0", "RAS"}) {
        const Plan plan = import_plan(write("a.fcsv", fcsv("4.10", ras, row))).plan;
        ASSERT_EQ(plan.boreholes.size(), 1U);
        EXPECT_EQ(plan.boreholes[0].position_in_ct, Vector3d(-10, -20, 30)) << ras;
        EXPECT_EQ(plan.boreholes[0].name, "P1");
        EXPECT_EQ(plan.boreholes[0].diameter_mm, 7);
        EXPECT_EQ(plan.boreholes[0].depth_mm, 6.5);
    }
    for (const char* lps : {"1", "LPS"})
        EXPECT_EQ(import_plan(write("a.fcsv", fcsv("4.11", lps, row))).plan.boreholes[0].position_in_ct,
                  Vector3d(10, 20, 30))
            << lps;
    EXPECT_EQ(import_plan(write("a.fcsv", fcsv("4.10", "", row)), kLps).plan.boreholes[0].position_in_ct,
              Vector3d(10, 20, 30));
    // Quoted labels, Windows line ends, and the fields that Slicer 5 adds.
    const Plan quoted =
        import_plan(
            write("b.fcsv", fcsv("5.6", "LPS",
                                 "id,1,2,3,0,0,0,1,1,1,0,\"a, \"\"b\"\"\",,,2,0\r\nid,9,2,3,0,0,0,1,1,1,0,,,,2,0\r\n")))
            .plan;
    EXPECT_EQ(quoted.boreholes[0].name, "a, \"b\"");
    EXPECT_EQ(quoted.boreholes[1].name, "b-2");
    const Plan marked = import_plan(write("c.fcsv", "\xEF\xBB\xBF" + fcsv("4.11", "LPS", row))).plan;
    EXPECT_EQ(marked.boreholes.at(0).position_in_ct, Vector3d(10, 20, 30)) << "Notepad's mark of UTF-8 before it";
}

TEST_F(PlanImportTest, FcsvThatDoesNotSayWhereItIsIsRefused) {
    const std::string row = "id_0,10,20,30,0,0,0,1,1,1,0,P1,,\n";
    EXPECT_SAYS(refusal("a.fcsv", fcsv("4.10", "", row)), "does not say its coordinate system");
    EXPECT_SAYS(refusal("a.fcsv", fcsv("4.10", "2", row)), "in voxels");
    EXPECT_SAYS(refusal("a.fcsv", fcsv("4.10", "LAS", row)), "\"LAS\", which is none");
    EXPECT_SAYS(refusal("a.fcsv", fcsv("4.10", "0\n# CoordinateSystem = 1", row)), "twice");
    EXPECT_SAYS(refusal("a.fcsv", fcsv("4.10", "RAS", row), kLps), "--frame says otherwise");
    EXPECT_SAYS(refusal("a.fcsv", fcsv("4.10", "0", "id,10,20\n")), "line 4 has 3 fields");
    EXPECT_SAYS(refusal("a.fcsv", fcsv("4.10", "0", "id,10,nan,30,0,0,0,1,1,1,0,P1,,\n")), "line 4 has y = \"nan\"");
    EXPECT_SAYS(refusal("a.fcsv", fcsv("4.10", "0", "id,10,2e300,30,0,0,0,1,1,1,0,P1,,\n")), "within 5 m");
    EXPECT_SAYS(refusal("a.fcsv", fcsv("4.10", "0", "id,10,\"2,5\",30,0,0,0,1,1,1,0,P1,,\n")), "not a number");
    EXPECT_SAYS(refusal("a.fcsv", fcsv("5.6", "0", "id,1,2,3,0,0,0,1,1,1,0,P1,,,1,0\n")), "not placed");
    EXPECT_SAYS(refusal("a.fcsv", fcsv("4.10", "0", "")), "holds no points");
    EXPECT_SAYS(refusal("a.fcsv", row), "names no column");
}

TEST_F(PlanImportTest, RealFcsvOfSlicerThreeAndFour) {
    const PlanImport four = import_plan(kData / "slicer_4.4.fcsv");  // CoordinateSystem = 0
    ASSERT_EQ(four.plan.boreholes.size(), 2U);
    EXPECT_EQ(four.plan.boreholes[0].position_in_ct, Vector3d(-43.3769, -23.1343, 0));
    const PlanImport three = import_plan(kData / "slicer_3.fcsv");
    ASSERT_EQ(three.plan.boreholes.size(), 56U);  // as its numPoints says
    EXPECT_EQ(three.plan.boreholes[0].position_in_ct, Vector3d(-12.5, 93.5, 7.5));
    ASSERT_EQ(three.notes.size(), 1U);
    EXPECT_SAYS(three.notes[0], "Slicer 3");
    EXPECT_THROW(import_plan(kData / "slicer_3.fcsv", kLps), InputError);
    EXPECT_THROW(import_plan(kData / "slicer_4_ruler.acsv"), InputError);
}

TEST_F(PlanImportTest, TrajectoriesOfATableNeedTheirFrame) {
    EXPECT_THROW(import_plan(kData / "seeg_trajectories.csv"), InputError);
    const Plan ras = import_plan(kData / "seeg_trajectories.csv", kRas).plan;
    ASSERT_EQ(ras.trajectories.size(), 15U);
    EXPECT_EQ(ras.trajectories[0].name, "RAMF");
    EXPECT_EQ(ras.trajectories[0].entry_in_ct, Vector3d(30.4242, 22.574, 8.00022));
    EXPECT_EQ(import_plan(kData / "seeg_trajectories.csv", kLps).plan.trajectories[0].target_in_ct,
              Vector3d(-52.9504, -29.8389, 14.3085));
    const PlanImport said = import_plan(
        write("t.tsv",
              "\xEF\xBB\xBF# SPACE=RAS\n# "
              "units=um\nname\tentry_x\tentry_y\tentry_z\ttarget_x\ttarget_y\ttarget_z\tdiameter_mm\tsurgeon\n"
              "A\t10000\t20000\t30000\t10000\t20000\t-5000\t2.5\tX\n"));
    EXPECT_TRUE(said.plan.trajectories[0].entry_in_ct.isApprox(Vector3d(-10, -20, 30), 1e-12));
    EXPECT_EQ(said.plan.trajectories[0].diameter_mm, 2.5);
    ASSERT_EQ(said.notes.size(), 1U);
    EXPECT_SAYS(said.notes[0], "surgeon");
}

TEST_F(PlanImportTest, TablesThatDoNotSayWhatTheyHoldAreRefused) {
    const auto table = [&](const std::string& text) { return refusal("t.csv", text, kLps); };
    const std::string header = "name,ex,ey,ez,tx,ty,tz\n";
    EXPECT_SAYS(table("name,start_x,start_y,start_z,end_x,end_y,end_z\nA,1,2,3,4,5,6\n"),
                "does not name an entry and a target");
    EXPECT_SAYS(table("trajectory_name,index,x,y,z\nA,1,2,3,4\n"), "its columns are trajectory_name, index, x, y, z");
    EXPECT_SAYS(table("Name,EX,EY,EZ,TX,TY,TZ\nA,1,2,3,4,5,6\n"), "does not name an entry");
    EXPECT_SAYS(table("name,ex,ex,ey,ez,tx,ty,tz\nA,1,2,3,4,5,6,7\n"), "\"ex\" twice");
    EXPECT_SAYS(table(header + "A,1,2,3,4,5\n"), "line 2 has 6 fields, the header has 7");
    EXPECT_SAYS(table(header + "A,1,2,3,1,2,3\n"), "of no length");
    EXPECT_SAYS(table(header + "A,1,2,3,4,5,6mm\n"), "\"6mm\"");
    EXPECT_SAYS(table(header + "A,1,2,3,4,5,inf\n"), "\"inf\"");
    EXPECT_SAYS(table(header), "holds no trajectories");
    EXPECT_SAYS(table("# units=inch\n" + header + "A,1,2,3,4,5,6\n"), "units=inch");
    EXPECT_SAYS(table("# SPACE=RAS\n" + header + "A,1,2,3,4,5,6\n"), "--frame says otherwise");
    EXPECT_SAYS(table(header + "A,0.01,0.02,0.03,0.01,0.02,0.09\n"), "cannot be millimetres");
    EXPECT_SAYS(refusal("x.xlsx", "PK\x03\x04zip"), "Save its table as CSV");
    EXPECT_SAYS(refusal("x.doc", "anything"), "of no kind that a plan is read from");
    EXPECT_SAYS(refusal("x.csv", ""), "is empty");
}

/// Two triangles that make a square of 30 mm, its four corners counter-clockwise.
const char* kSquareObj = "v 0 0 0\nv 30 0 0\nv 30 30 0\nv 0 30 0\nf 1 2 3\nf 1 3 4\n";

TEST_F(PlanImportTest, LinesOfMeshFilesAreOsteotomyLines) {
    const Plan lines =
        import_plan(write("cut.obj", "# SPACE=RAS\nv 1 2 3\nv 10 2 3\nv 10 20 3\nl 1 2 3\no lid\nl 1 2 3 1\n")).plan;
    ASSERT_EQ(lines.osteotomy_lines.size(), 2U);
    EXPECT_EQ(lines.osteotomy_lines[0].name, "cut 1");
    EXPECT_EQ(lines.osteotomy_lines[0].points_in_ct[1], Vector3d(-10, -2, 3));
    EXPECT_FALSE(lines.osteotomy_lines[0].closed);
    EXPECT_EQ(lines.osteotomy_lines[1].name, "lid");
    EXPECT_TRUE(lines.osteotomy_lines[1].closed);
    EXPECT_EQ(lines.osteotomy_lines[1].points_in_ct.size(), 3U);
    // Of an open surface, its edge.
    const Plan edge = import_plan(write("patch.obj", std::string("# SPACE=LPS\n") + kSquareObj)).plan;
    ASSERT_EQ(edge.osteotomy_lines.size(), 1U);
    EXPECT_TRUE(edge.osteotomy_lines[0].closed);
    EXPECT_EQ(edge.osteotomy_lines[0].points_in_ct.size(), 4U);
    EXPECT_EQ(edge.osteotomy_lines[0].name, "patch");
    // Segments end to end in a legacy VTK file, as many programs write curves.
    const std::string vtk =
        "# vtk DataFile Version 3.0\n3D Slicer output. SPACE=LPS\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 10 0 "
        "0 10 10 0 "
        "10 10 10\n"
        "LINES 3 9\n2 0 1\n2 1 2\n2 2 3\n";
    const Plan joined = import_plan(write("curve.vtk", vtk)).plan;
    ASSERT_EQ(joined.osteotomy_lines.size(), 1U);
    EXPECT_EQ(joined.osteotomy_lines[0].points_in_ct.size(), 4U);
    std::string unmarked = vtk;
    unmarked.replace(unmarked.find("3D Slicer output. SPACE=LPS"), 27, "made by somebody else       ");
    EXPECT_SAYS(refusal("curve.vtk", unmarked), "does not say its coordinate system");
    EXPECT_EQ(import_plan(write("curve.vtk", unmarked), kRas).plan.osteotomy_lines[0].points_in_ct[2],
              Vector3d(-10, -10, 0));
}

TEST_F(PlanImportTest, EdgesOfAPlyWithoutFacesAreLines) {
    const auto ply = [](const std::string& edges, const std::string& faces = "") {
        return "ply\nformat ascii 1.0\ncomment SPACE=LPS\nelement vertex 4\nproperty float x\nproperty float "
               "y\nproperty "
               "float z\nelement edge 3\nproperty int vertex1\nproperty int vertex2\n" +
               std::string(faces.empty() ? "" : "element face 1\nproperty list uchar int vertex_indices\n") +
               "end_header\n0 0 0\n10 0 0\n10 10 0\n10 10 10\n" + edges + faces;
    };
    const Plan plan = import_plan(write("l.ply", ply("0 1\n1 2\n2 3\n"))).plan;
    ASSERT_EQ(plan.osteotomy_lines.size(), 1U);
    EXPECT_EQ(plan.osteotomy_lines[0].points_in_ct.size(), 4U);
    EXPECT_EQ(plan.osteotomy_lines[0].points_in_ct[3], Vector3d(10, 10, 10));
    EXPECT_SAYS(refusal("l.ply", ply("0 1\n1 2\n2 4\n")), "an edge with an end that does not exist");
    const Plan patch = import_plan(write("l.ply", ply("0 1\n1 2\n2 0\n", "3 0 1 2\n"))).plan;
    ASSERT_EQ(patch.osteotomy_lines.size(), 1U) << "its border alone";
    EXPECT_EQ(patch.osteotomy_lines[0].points_in_ct.size(), 3U);
}

TEST_F(PlanImportTest, MeshesThatAreNoLinesAreRefused) {
    EXPECT_SAYS(refusal("a.obj", kSquareObj), "does not say its coordinate system");
    EXPECT_SAYS(refusal("a.obj", std::string("# SPACE=LPS\n# SPACE=RAS\n") + kSquareObj), "both");
    EXPECT_SAYS(refusal("a.obj", std::string("# SPACE=scanner\n") + kSquareObj), "scanner, neither LPS nor RAS");
    const std::string tetrahedron =
        "# SPACE=LPS\nv 0 0 0\nv 30 0 0\nv 0 30 0\nv 0 0 30\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
    EXPECT_SAYS(refusal("a.obj", tetrahedron), "closed surface of 4 triangles");
    std::string stack = "# SPACE=LPS\n";
    for (int z = 0; z < 4; ++z)
        stack += fmt::format("v 0 0 {0}\nv 30 0 {0}\nv 30 30 {0}\nl {1} {2} {3} {1}\n", 3 * z, 3 * z + 1, 3 * z + 2,
                             3 * z + 3);
    EXPECT_SAYS(refusal("a.obj", stack), "contours at 4 heights");
    EXPECT_SAYS(refusal("a.obj", "# SPACE=LPS\nv 0 0 0\nv 9 0 0\nl 1 5\n"), "which does not exist");
    EXPECT_SAYS(refusal("a.obj", "# SPACE=LPS\nv 0 0 nan\nv 9 0 0\nl 1 2\n"), "not a finite number");
    EXPECT_SAYS(refusal("a.stl", "solid SPACE=LPS\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"),
                "is cut short");
    EXPECT_SAYS(refusal("a.stl", std::string(90, 'x')), "announces");
    EXPECT_SAYS(refusal("a.vtp", "<?xml version=\"1.0\"?><VTKFile type=\"PolyData\"><PolyData>"), "a.vtp");
    EXPECT_SAYS(refusal("a.vtk", "no VTK file"), "is not a VTK file");
}

TEST_F(PlanImportTest, AVtpThatIsCutAnywhereIsRefusedAndNeverReadAsLess) {
    Plan plan = test::random_plan(3);
    write_plan_vtp(plan, folder_.path() / "whole.vtp");
    const std::string whole = read_whole(folder_.path() / "whole.vtp");
    for (std::size_t part = 1; part < 20; ++part)
        EXPECT_FALSE(refusal("cut.vtp", whole.substr(0, whole.size() * part / 20)).empty()) << part;
}

TEST_F(PlanImportTest, AnAngleIsTwoCutsThatMeetAndARoiIsRefused) {
    const auto markup = [](const std::string& type) {
        return R"({"@schema": "markups-schema-v1.0.3.json#", "markups": [{"type": ")" + type +
               R"(", "coordinateSystem": "LPS", "coordinateUnits": "mm", "controlPoints": [{"position": [10, 0, 0]}, {"position": [0, 0, 0]}, {"position": [0, 20, 0]}]}]})";
    };
    const Plan plan = import_plan(write("corner.mrk.json", markup("Angle"))).plan;
    ASSERT_EQ(plan.osteotomy_lines.size(), 1U);
    EXPECT_EQ(plan.osteotomy_lines[0].name, "corner 90.0 deg");
    EXPECT_EQ(plan.osteotomy_lines[0].points_in_ct[1], Vector3d(0, 0, 0));
    EXPECT_FALSE(plan.osteotomy_lines[0].closed);
    const std::string said = refusal("box.mrk.json", markup("ROI"));
    EXPECT_SAYS(said, "(\"box\") is of type \"ROI\"");
    EXPECT_SAYS(said, "closed curve");
    EXPECT_SAYS(refusal("corner.mrk.json", markup("Angle"), kRas), "--frame says otherwise");
}

TEST_F(PlanImportTest, AFolderIsOnePlanOfAllItsFiles) {
    write("a.fcsv", fcsv("4.10", "0", "id_0,10,20,30,0,0,0,1,1,1,0,P1,,\n"));
    write("b.csv", "# SPACE=LPS\nname,ex,ey,ez,tx,ty,tz\nA,1,2,3,4,5,6\n");
    write("notes.txt", "not a plan");
    write("old.acsv", "point|1|2|3|1|1");
    write("._a.fcsv", "what a Mac keeps beside a file");
    write(".hidden.csv", "# SPACE=LPS\nname,ex,ey,ez,tx,ty,tz\nB,1,2,3,4,5,6\n");
    std::filesystem::create_directory(folder_.path() / "more");
    const PlanImport read = import_plan(folder_.path());
    EXPECT_EQ(read.plan.boreholes.size(), 1U);
    EXPECT_EQ(read.plan.trajectories.size(), 1U);
    ASSERT_EQ(read.notes.size(), 1U);
    EXPECT_NE(read.notes[0].find("more/, notes.txt, old.acsv"), std::string::npos) << read.notes[0];
}

TEST_F(PlanImportTest, ACurveOfFewPointsIsSaidToRunStraight) {
    const auto notes = [&](const char* type, const std::vector<Vector3d>& points) {
        std::string listed;
        for (const Vector3d& p : points)
            listed += fmt::format(R"({}{{"position": [{}, {}, {}]}})", listed.empty() ? "" : ", ", p.x(), p.y(), p.z());
        return import_plan(
                   write("cut.mrk.json", R"({"@schema": "markups-schema-v1.0.3.json#", "markups": [{"type": ")" +
                                             std::string(type) +
                                             R"(", "name": "Flap", "coordinateSystem": "LPS", "coordinateUnits": "mm",)"
                                             R"( "controlPoints": [)" +
                                             listed + "]}]}"))
            .notes;
    };
    const std::vector<Vector3d> square{{0, 0, 0}, {40, 0, 0}, {40, 40, 0}, {0, 40, 0}};
    const auto said = notes("ClosedCurve", square);
    ASSERT_EQ(said.size(), 1U);  // VTK 9.1's vtkParametricSpline, closed, passes the middle of a side at 47.500 mm
    EXPECT_NE(said[0].find("\"Flap\" runs straight between its 4 points"), std::string::npos) << said[0];
    EXPECT_NE(said[0].find("up to 7.5 mm"), std::string::npos) << said[0];
    EXPECT_TRUE(notes("Angle", {square.begin(), square.begin() + 3}).empty()) << "straight by what it is";
    std::vector<Vector3d> round;
    for (int i = 0; i < 24; ++i) round.emplace_back(20 * std::cos(i * 0.2618), 20 * std::sin(i * 0.2618), 0);
    EXPECT_TRUE(notes("ClosedCurve", round).empty()) << "0.17 mm beside its chords";
}

TEST_F(PlanImportTest, ANameIsOneLine) {
    const fs::path file = write(
        "way.mrk.json",
        R"({"@schema": "markups-schema-v1.0.3.json#", "markups": [{"type": "Line", "name": "Left\n\tway  in\r\n",)"
        R"( "coordinateSystem": "LPS", "coordinateUnits": "mm", "controlPoints":)"
        R"( [{"position": [0, 0, 0]}, {"position": [0, 0, 50]}]}]})");
    EXPECT_EQ(import_plan(file).plan.trajectories.at(0).name, "Left way  in");
}

TEST_F(PlanImportTest, NoNameAndNoNoteGivesOrdersToATerminal) {
    const std::string line = R"({"@schema": "markups-schema-v1.0.3.json#", "markups": [{"type": "Line",)"
                             R"( "name": "ves\u2028sel\u202e\u008512", "coordinateSystem": "LPS",)"
                             R"( "coordinateUnits": "mm", "controlPoints":)"
                             R"( [{"position": [0, 0, 0]}, {"position": [0, 0, 50]}]}]})";
    write("way.mrk.json", line);
    write("evil\n\x1B[31mred", "?");
    const PlanImport read = import_plan(folder_.path());
    EXPECT_EQ(read.plan.trajectories.at(0).name, "ves sel 12");
    ASSERT_EQ(read.notes.size(), 1U);
    EXPECT_SAYS(read.notes[0], ": evil [31mred. Give a file");
}

}  // namespace
}  // namespace planlight
