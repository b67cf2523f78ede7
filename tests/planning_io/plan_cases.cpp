#include "tests/planning_io/plan_cases.h"

#include <fmt/format.h>

#include <limits>

#include "planning_io/files/safe_write.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/plan/plan_rtstruct.h"
#include "planning_io/plan/plan_shapes.h"
#include "tests/support/analytic_head.h"

namespace planlight::test {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr const char* kFrameOfReference = "1.2.826.0.1.3680043.8.498.7";
const PlanImportSettings kNothingSaid, kLps{Space::lps, {}}, kRas{Space::ras, {}}, kSameCt{{}, kFrameOfReference};

PlanCase text(const std::string& name, const std::string& says, const std::string& file, const std::string& content,
              const PlanImportSettings& settings = kNothingSaid) {
    return {name, says,
            [=](const fs::path& folder) {
                write_safely(folder / file, content);
                return folder / file;
            },
            settings};
}

/// One markup in the words of 3D Slicer; what a case changes is a parameter.
struct Markup {
    std::string type = "Line", system = "\"LPS\"", units = "\"coordinateUnits\": \"mm\",", schema = "1.0.3";
    std::string points = "[-10, -20, 30]|[1, 2, 3]";  ///< positions apart by '|'
    std::string status = "defined", more;             ///< `more` goes before the control points
    std::string text() const {
        std::string list;
        for (std::size_t at = 0; at <= points.size();) {
            const auto end = std::min(points.find('|', at), points.size());
            list += (list.empty() ? "" : ", ") +
                    fmt::format(R"({{"position": {}, "positionStatus": "{}"}})", points.substr(at, end - at), status);
            at = end + 1;
        }
        return fmt::format(
            R"({{"@schema": "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/markups-schema-v{}.json#", )"
            R"("markups": [{{"type": "{}", "name": "T", "coordinateSystem": {}, {} {} "controlPoints": [{}]}}]}})",
            schema, type, system, units, more, list);
    }
};

template <class Change>
std::string markup(Change change) {
    Markup m;
    change(m);
    return m.text();
}

std::string fcsv(const std::string& system, const std::string& rows, const std::string& version = "4.11") {
    return "# Markups fiducial file version = " + version + "\n" +
           (system.empty() ? "" : "# CoordinateSystem = " + system + "\n") +
           "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n" + rows;
}

const std::string kTable = "name,ex,ey,ez,tx,ty,tz\n";
const std::string kVtk =
    "# vtk DataFile Version 3.0\n{}\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n-10 -20 30 10 0 0 10 10 0\nLINES 1 4\n3 "
    "0 1 2\n";

std::string vtk(const std::string& second_line) {
    return fmt::format(fmt::runtime(kVtk), second_line);
}

Plan small_plan() {
    Plan plan;
    plan.trajectories.push_back({"T", {-10, -20, 30}, {1, 2, 3}, 2, {}});
    plan.boreholes.push_back({"B", {-10, 20, 30}, Vector3d(0, -1, 0), 7, 6, {}});
    return plan;
}

PlanCase rtstruct(const std::string& name, const std::string& says, const PlanImportSettings& settings,
                  double share = 1) {
    return {
        name, says,
        [=](const fs::path& folder) {
            write_plan_rtstruct(small_plan(), {"code", kFrameOfReference, "2026-01-01T00:00:00Z"}, folder / "plan.dcm");
            std::string content = read_whole(folder / "plan.dcm");
            content.resize(static_cast<std::size_t>(share * static_cast<double>(content.size())));
            if (share < 1) write_safely(folder / "plan.dcm", content);
            return folder / "plan.dcm";
        },
        settings};
}

void add_sound_markups(std::vector<PlanCase>& list) {
    for (const char* schema : {"1.0.0", "1.0.1", "1.0.2", "1.0.3"})
        list.push_back(text(fmt::format("markups, schema {}, LPS, mm", schema), "", "p.mrk.json",
                            markup([&](Markup& m) { m.schema = schema; })));
    list.push_back(text("markups, schema 1.0.2, unit not said (mm by that schema)", "", "p.mrk.json",
                        markup([](Markup& m) { m.schema = "1.0.2", m.units = ""; })));
    list.push_back(text("markups, RAS", "", "p.mrk.json",
                        markup([](Markup& m) { m.system = "\"RAS\"", m.points = "[10, 20, 30]|[1, 2, 3]"; })));
    list.push_back(text("markups, micrometres", "", "p.mrk.json", markup([](Markup& m) {
                            m.units = "\"coordinateUnits\": \"um\",", m.points = "[-10000, -20000, 30000]|[1, 2, 3]";
                        })));
    list.push_back(text("markups, UCUM unit", "", "p.mrk.json",
                        markup([](Markup& m) { m.units = R"("coordinateUnits": ["mm", "UCUM", "millimeter"],)"; })));
    for (const char* type : {"Fiducial", "Curve", "ClosedCurve", "Angle"})
        list.push_back(text(std::string("markups, ") + type, "", "p.mrk.json", markup([&](Markup& m) {
                                m.type = type, m.points = "[-10, -20, 30]|[1, 2, 3]|[1, 30, 3]";
                            })));
    list.push_back(text(
        "markups, Plane", "", "p.mrk.json", markup([](Markup& m) {
            m.type = "Plane", m.points = "[-10, -20, 30]";
            m.more = R"("center": [-10, -20, 30], "orientation": [1, 0, 0, 0, 1, 0, 0, 0, 1], "size": [80, 40, 0],)";
        })));
}

void add_spoilt_markups(std::vector<PlanCase>& list) {
    const auto add = [&](const std::string& name, const std::string& says, auto change) {
        list.push_back(text("markups: " + name, says, "p.mrk.json", markup(change)));
    };
    add("no coordinate system", "coordinateSystem", [](Markup& m) { m.system = "null"; });
    add("a coordinate system of another word", "\"lps\"", [](Markup& m) { m.system = "\"lps\""; });
    add("two coordinate systems", "twice", [](Markup& m) { m.more = "\"coordinateSystem\": \"RAS\","; });
    add("no unit, schema 1.0.3", "coordinateUnits", [](Markup& m) { m.units = ""; });
    add("centimetres", "\"cm\"", [](Markup& m) { m.units = "\"coordinateUnits\": \"cm\","; });
    add("a schema of another version", "not a 3D Slicer markups schema 1.0.x", [](Markup& m) { m.schema = "2.0.0"; });
    add("a coordinate that is not a number", "", [](Markup& m) { m.points = "[1, 2, NaN]|[1, 2, 3]"; });
    list.back().says = "JSON";
    add("a coordinate of two numbers", "3 numbers", [](Markup& m) { m.points = "[1, 2]|[1, 2, 3]"; });
    add("a coordinate 90 m away", "5 m", [](Markup& m) { m.points = "[1, 2, 90000]|[1, 2, 3]"; });
    add("a line of no length", "no length", [](Markup& m) { m.points = "[1, 2, 3]|[1, 2, 3]"; });
    add("a line of one point", "fewer than 2", [](Markup& m) { m.points = "[1, 2, 3]"; });
    add("a line of three points", "more than the two", [](Markup& m) { m.points = "[1, 2, 3]|[2, 2, 30]|[4, 5, 6]"; });
    add("a curve with a double point", "at the place of the point before",
        [](Markup& m) { m.type = "Curve", m.points = "[1, 2, 3]|[9, 9, 9]|[9, 9, 9]"; });
    add("a point that is not placed", "not placed", [](Markup& m) { m.status = "preview"; });
    add("metres called millimetres", "cannot be millimetres",
        [](Markup& m) { m.points = "[0.01, 0.02, 0.03]|[0.01, 0.02, 0.09]"; });
    add("a ROI", "a box", [](Markup& m) { m.type = "ROI"; });
    add("a kind that no plan has", "means nothing in a plan", [](Markup& m) { m.type = "Spiral"; });
    add("a diameter of 900 mm", "diameter_mm", [](Markup& m) {
        m.type = "Fiducial", m.points = "[1, 2, 3], \"description\": \"diameter_mm=900\"|[40, 2, 3]";
    });
    for (const char* said : {"diameter=7", "Diameter_mm = 7", "diamter_mm=7", "depth_cm=1"})
        add(fmt::format("a name that is nearly one of ours ({})", said), "is meant", [=](Markup& m) {
            m.type = "Fiducial",
            m.points = fmt::format("[1, 2, 3], \"description\": \"for the drain, {}\"|[40, 2, 3]", said);
        });
    add("a line whose ends have two diameters", "another diameter_mm", [](Markup& m) {
        m.points = "[1, 2, 3], \"description\": \"diameter_mm=3\"|[40, 2, 3], \"description\": \"diameter_mm=4\"";
    });
    const std::string plane =
        R"("center": [1, 2, 3], "orientation": [1, 0, 0, 0, 1, 0, 0, 0, 1], "size": [80, {}, 0],)";
    add("a plane without a height", "nothing along a side", [=](Markup& m) {
        m.type = "Plane", m.points = "[1, 2, 3]", m.more = plane, m.more.replace(plane.find("{}"), 2, "0");
    });
    add("a plane that is not placed", "not placed", [=](Markup& m) {
        m.type = "Plane", m.points = "[1, 2, 3]", m.status = "undefined";
        m.more = plane, m.more.replace(plane.find("{}"), 2, "40");
    });
    list.push_back(
        text("markups: LPS, and --frame RAS said", "--frame says otherwise", "p.mrk.json", Markup().text(), kRas));
    list.push_back(text("markups: cut short", "JSON", "p.mrk.json", Markup().text().substr(0, 250)));
    list.push_back(text("markups: 100,000 levels deep", "", "p.mrk.json", std::string(100000, '[')));
    list.back().says = "levels";
    list.push_back(text("markups: empty file", "is empty", "p.mrk.json", ""));
}

void add_spoilt_tables(std::vector<PlanCase>& list) {
    const std::string row = "id_0,10,20,30,0,0,0,1,1,1,0,P1,,\n";
    const auto points = [&](const std::string& name, const std::string& says, const std::string& content) {
        list.push_back(text(".fcsv: " + name, says, "p.fcsv", content));
    };
    points("no coordinate system", "does not say its coordinate system", fcsv("", row));
    points("in voxels", "in voxels", fcsv("2", row));
    points("a coordinate system of another word", "which is none", fcsv("LAS", row));
    points("two coordinate systems", "twice", fcsv("0\n# CoordinateSystem = 1", row));
    points("a row cut short", "3 fields", fcsv("0", "id,10,20\n"));
    points("a coordinate that is not a number", "\"nan\"", fcsv("0", "id,10,nan,30,0,0,0,1,1,1,0,P1,,\n"));
    points("a decimal comma", "not a number", fcsv("0", "id,10,\"2,5\",30,0,0,0,1,1,1,0,P1,,\n"));
    points("a point that is not placed", "not placed", fcsv("0", "id,1,2,3,0,0,0,1,1,1,0,P1,,,1,0\n", "5.6"));
    points("no points", "holds no points", fcsv("0", ""));
    const auto table = [&](const std::string& name, const std::string& says, const std::string& content,
                           const PlanImportSettings& settings = kLps) {
        list.push_back(text("table: " + name, says, "p.csv", content, settings));
    };
    table("no frame", "does not say its coordinate system", kTable + "A,1,2,3,40,5,6\n", kNothingSaid);
    table("RAS, and --frame LPS said", "--frame says otherwise", "# SPACE=RAS\n" + kTable + "A,1,2,3,40,5,6\n");
    table("inches", "units=inch", "# units=inch\n" + kTable + "A,1,2,3,4,5,6\n");
    table("metres called millimetres", "cannot be millimetres", kTable + "A,0.01,0.02,0.03,0.01,0.02,0.09\n");
    table("start and end, which do not say the entry", "does not name an entry and a target",
          "name,start_x,start_y,start_z,end_x,end_y,end_z\nA,1,2,3,4,5,6\n");
    table("a list of contacts", "its columns are", "trajectory_name,index,x,y,z\nA,1,2,3,4\n");
    table("a column twice", "twice", "name,ex,ex,ey,ez,tx,ty,tz\nA,1,2,3,4,5,6,7\n");
    table("a row cut short", "has 6 fields", kTable + "A,1,2,3,4,5\n");
    table("a trajectory of no length", "of no length", kTable + "A,1,2,3,1,2,3\n");
    table("a number with its unit", "\"6mm\"", kTable + "A,1,2,3,4,5,6mm\n");
    table("an infinite number", "\"inf\"", kTable + "A,1,2,3,4,5,inf\n");
    table("no trajectories", "holds no trajectories", kTable);
    table("another coordinate system below its rows", "says that it is in RAS",
          kTable + "A,1,2,3,40,5,6\n# SPACE=RAS\nB,1,2,9,40,5,6\n");
    table("a unit below its rows", "below its first row", kTable + "A,1,2,3,40,5,6\n# units=um\nB,1,2,9,40,5,6\n");
}

void add_spoilt_shapes(std::vector<PlanCase>& list) {
    const auto obj = [&](const std::string& name, const std::string& says, const std::string& content) {
        list.push_back(text(name, says, "p.obj", content));
    };
    obj("lines: no frame", "does not say its coordinate system", "v 0 0 0\nv 30 0 0\nl 1 2\n");
    obj("lines: both frames", "both", "# SPACE=LPS\n# SPACE=RAS\nv 0 0 0\nv 30 0 0\nl 1 2\n");
    obj("lines: a point that does not exist", "does not exist", "# SPACE=LPS\nv 0 0 0\nv 9 0 0\nl 1 5\n");
    obj("lines: a coordinate that is not a number", "finite", "# SPACE=LPS\nv 0 0 nan\nv 9 0 0\nl 1 2\n");
    obj("a closed surface", "without an edge to cut along",
        "# SPACE=LPS\nv 0 0 0\nv 30 0 0\nv 0 30 0\nv 0 0 30\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
    std::string stack = "# SPACE=LPS\n";
    for (int z = 0; z < 4; ++z)
        stack += fmt::format("v 0 0 {0}\nv 30 0 {0}\nv 30 30 {0}\nl {1} {2} {3} {1}\n", 3 * z, 3 * z + 1, 3 * z + 2,
                             3 * z + 3);
    obj("contours at four heights (a solid)", "a solid", stack);
    list.push_back(text(".stl cut short", "cut short", "p.stl",
                        "solid SPACE=LPS\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"));
    list.push_back(text(".stl whose size is not that of its triangles", "announces", "p.stl", std::string(90, 'x')));
    list.push_back(
        text(".vtk without a frame", "does not say its coordinate system", "p.vtk", vtk("made by somebody")));
    list.push_back(text(".vtk that is none", "is not a VTK file", "p.vtk", "no VTK file"));
    list.push_back(
        text(".vtp cut short", "p.vtp", "p.vtp", "<?xml version=\"1.0\"?><VTKFile type=\"PolyData\"><PolyData>"));
    list.push_back(rtstruct("RTSTRUCT of another frame of reference than the CT's", "1.2.3", {{}, "1.2.3"}));
    list.push_back(rtstruct("RTSTRUCT, and the CT has no frame of reference", "--accept-frame", {{}, ""}));
    list.push_back(rtstruct("RTSTRUCT, and --frame RAS said", "always LPS", {Space::ras, kFrameOfReference}));
    list.push_back(rtstruct("RTSTRUCT cut short", "cut short", kSameCt, 0.6));
    list.push_back(text("a spreadsheet", "Save its table as CSV", "p.xlsx", "PK\x03\x04zip"));
    list.push_back(text("an annotation of 3D Slicer 4", "says no frame", "p.acsv", "# Annotation file\n"));
    list.push_back(text("a scene of 3D Slicer", "scene", "p.mrml", "<MRML></MRML>"));
    list.push_back(text("a file of another kind", "of no kind", "p.doc", "anything"));
    list.push_back(
        {"a folder without plan files", "holds no plan file", [](const fs::path& folder) { return folder; }, {}});
    list.push_back({"a device",
                    "a pipe or a device",
                    [](const fs::path& folder) {
                        fs::create_symlink("/dev/zero", folder / "p.mrk.json");
                        return folder / "p.mrk.json";
                    },
                    {}});
    list.push_back(
        {"a file that is not there", "", [](const fs::path& folder) { return folder / "none.mrk.json"; }, {}});
    list.back().says = "none.mrk.json";
}

}  // namespace

std::vector<PlanCase> sound_plans() {
    std::vector<PlanCase> list;
    add_sound_markups(list);
    for (const char* ras : {"0", "RAS"})
        list.push_back(text(fmt::format(".fcsv, CoordinateSystem = {}", ras), "", "p.fcsv",
                            fcsv(ras, "id_0,10,20,30,0,0,0,1,1,1,0,P1,,\n")));
    for (const char* lps : {"1", "LPS"})
        list.push_back(text(fmt::format(".fcsv, CoordinateSystem = {}", lps), "", "p.fcsv",
                            fcsv(lps, "id_0,-10,-20,30,0,0,0,1,1,1,0,P1,,\n")));
    list.push_back(text(".fcsv that does not say its frame, --frame RAS", "", "p.fcsv",
                        fcsv("", "id_0,10,20,30,0,0,0,1,1,1,0,P1,,\n", "4.4"), kRas));
    list.push_back(text(
        "table of trajectories, SPACE=RAS, micrometres", "", "p.tsv",
        "# SPACE=RAS\n# "
        "units=um\nname\tentry_x\tentry_y\tentry_z\ttarget_x\ttarget_y\ttarget_z\nA\t10000\t20000\t30000\t1\t2\t3\n"));
    list.push_back(text("table of trajectories, --frame LPS", "", "p.csv", kTable + "A,-10,-20,30,1,2,3\n", kLps));
    list.push_back(
        text("lines of an .obj, SPACE=RAS", "", "p.obj", "# SPACE=RAS\nv 10 20 30\nv 10 2 3\nv 10 20 3\nl 1 2 3\n"));
    list.push_back(text("lines of a .vtk, SPACE=LPS", "", "p.vtk", vtk("3D Slicer output. SPACE=LPS")));
    list.push_back(text("the edge of an open surface (.ply), SPACE=LPS", "", "p.ply",
                        "ply\nformat ascii 1.0\ncomment SPACE=LPS\nelement vertex 4\nproperty float x\nproperty float "
                        "y\nproperty float z\n"
                        "element face 2\nproperty list uchar int vertex_indices\nend_header\n-10 -20 30\n20 -20 30\n20 "
                        "20 30\n-10 20 30\n3 0 1 2\n3 0 2 3\n"));
    list.push_back({"our own .vtp",
                    "",
                    [](const fs::path& folder) {
                        write_plan_vtp(small_plan(), folder / "p.vtp");
                        return folder / "p.vtp";
                    },
                    {}});
    list.push_back(rtstruct("our own RTSTRUCT, frame of reference of the CT", "", kSameCt));
    list.push_back({"a folder of two files",
                    "",
                    [](const fs::path& folder) {
                        write_safely(folder / "a.mrk.json", Markup().text());
                        write_safely(folder / "b.fcsv", fcsv("0", "id_0,10,20,30,0,0,0,1,1,1,0,P1,,\n"));
                        write_safely(folder / "notes.txt", "no plan");
                        return folder;
                    },
                    {}});
    return list;
}

std::vector<PlanCase> spoilt_plans() {
    std::vector<PlanCase> list;
    add_spoilt_markups(list);
    add_spoilt_tables(list);
    add_spoilt_shapes(list);
    return list;
}

VolumeBox box_of_head() {
    VolumeBox box;
    box.ct_from_voxel.translation() = Vector3d::Constant(-160);
    box.size = {321, 321, 321};
    return box;
}

std::vector<PlanOnHead> plans_on_head() {
    const auto on_skin = [](double x, double y, double z) { return on_analytic_head({x, y, z}); };
    Plan good;
    const Vector3d entry = on_skin(35, -80, 50), hole = on_skin(-40, -60, 60);
    good.trajectories.push_back({"T1", entry, entry - 40 * analytic_head_normal(entry), 2, {}});
    good.boreholes.push_back({"B1", hole, {}, 7, 6, {}});
    good.osteotomy_lines.push_back(
        {"O1", {on_skin(10, -90, 40), on_skin(-10, -90, 40), on_skin(-10, -80, 60)}, true, {}});
    std::vector<PlanOnHead> list{{"entry, borehole and line on the skin", "", good}};
    const auto add = [&](const std::string& name, const std::string& says, auto spoil) {
        list.push_back({name, says, good});
        spoil(list.back().plan);
    };
    add("a named side that is right", "", [](Plan& p) { p.boreholes[0].name = "B1 right"; });  // LPS: x < 0 is right
    add("a side in a name that is the other one", "it is named left", [](Plan& p) { p.boreholes[0].name = "B1 left"; });
    add("entry and target swapped", "swapped",
        [](Plan& p) { std::swap(p.trajectories[0].entry_in_ct, p.trajectories[0].target_in_ct); });
    add("a target outside the body", "its target lies outside the body",
        [&](Plan& p) { p.trajectories[0].target_in_ct = entry + 25 * analytic_head_normal(entry); });
    add("entry and target 0.4 mm apart", "only 0.40 mm apart",
        [&](Plan& p) { p.trajectories[0].target_in_ct = entry - 0.4 * analytic_head_normal(entry); });
    add("a borehole 40 mm over the skin", "mm from the skin",
        [&](Plan& p) { p.boreholes[0].position_in_ct = hole + 40 * analytic_head_normal(hole); });
    add("two of three items 15 mm over the skin", "items lie more than 10 mm from the skin", [&](Plan& p) {
        p.boreholes[0].position_in_ct = hole + 15 * analytic_head_normal(hole);
        p.trajectories[0].entry_in_ct = entry + 15 * analytic_head_normal(entry);
    });
    add("borehole and line 7 mm over the skin", "lie in the air", [&](Plan& p) {
        const auto lift = [](Vector3d& v) { v += 7 * analytic_head_normal(v); };
        lift(p.boreholes[0].position_in_ct);
        for (auto& v : p.osteotomy_lines[0].points_in_ct) lift(v);
    });
    add("a borehole 250 mm deep", "250 mm deep", [](Plan& p) { p.boreholes[0].depth_mm = 250; });
    add("an axis that points out of the body", "out of the body",
        [&](Plan& p) { p.boreholes[0].axis_in_ct = analytic_head_normal(hole); });
    add("a coordinate that is not a number", "not finite",
        [](Plan& p) { p.boreholes[0].position_in_ct.x() = std::numeric_limits<double>::quiet_NaN(); });
    add("a line outside the scanned volume", "outside the volume",
        [](Plan& p) { p.osteotomy_lines[0].points_in_ct[1].z() = 190; });
    add("x and y of all points exchanged", "", [](Plan& p) {
        const auto turn = [](Vector3d& v) { v = Vector3d(v.y(), v.x(), v.z()); };
        turn(p.trajectories[0].entry_in_ct), turn(p.trajectories[0].target_in_ct), turn(p.boreholes[0].position_in_ct);
        for (auto& v : p.osteotomy_lines[0].points_in_ct) turn(v);
    });
    list.back().says = "skin";
    add("RAS numbers in a file that says LPS", "", [](Plan& p) {
        const auto turn = [](Vector3d& v) { v = Vector3d(-v.x(), -v.y(), v.z()); };
        turn(p.trajectories[0].entry_in_ct), turn(p.trajectories[0].target_in_ct), turn(p.boreholes[0].position_in_ct);
        for (auto& v : p.osteotomy_lines[0].points_in_ct) turn(v);
    });
    list.back().says = "axes are exchanged";
    return list;
}

}  // namespace planlight::test
