#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/app/on_example_patient.h"
#include "tests/planning_io/synthetic_files.h"
#include "tests/planning_io/synthetic_series.h"
#include "tests/support/sanitizer.h"

namespace planlight::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

TEST_F(CommandsTest, PrepareMakesACaseThatSaysWhatItHolds) {
    const json result = json::parse(prepared().out);
    EXPECT_EQ(result["plan_items"], 6);
    // An adult head down to the upper lip: 2 to 5 litres.
    EXPECT_GT(result["body_ml"].get<double>(), 2000);
    EXPECT_LT(result["body_ml"].get<double>(), 5000);
    EXPECT_TRUE(fs::exists(root() / "case" / "case.json"));
}

TEST_F(CommandsTest, PrepareEndsWithAReportThatNeedsNothingElse) {
    prepared();
    const std::string page = read_text(root() / "case" / "report.html");
    std::size_t pictures = 0;
    for (auto at = page.find("data:image/png;base64,"); at != std::string::npos;
         at = page.find("data:image/png;base64,", at + 1))
        ++pictures;
    EXPECT_EQ(pictures, 14u)
        << "slices through the middle and through the plan, the head from four sides, from above and from below, "
           "what was thrown away from two";
    EXPECT_EQ(page.find("://"), std::string::npos) << "nothing comes from a network";
    const json report = read_json(root() / "case" / "report.json");
    EXPECT_EQ(report["case"], json::parse(prepared().out)["case"]);
    ASSERT_EQ(report["items"].size(), 6u);
    for (const auto& item : report["items"]) EXPECT_LT(item["distance_to_skin_mm"].get<double>(), 10) << item["name"];
    EXPECT_EQ(report["threshold_unit"], "HU");
    EXPECT_TRUE(report["threshold_automatic"].get<bool>());
    // The head holder's plates lie behind this patient, and nothing of the head is among what was thrown away.
    ASSERT_FALSE(report["removed"].empty());
    double removed_ml = 0;
    for (const auto& piece : report["removed"]) removed_ml += piece["ml"].get<double>();
    EXPECT_NEAR(removed_ml, report["removed_ml"].get<double>(), 0.02 * removed_ml);
    const std::string sums = read_text(root() / "case" / "checksums.xxh128");
    for (const char* name : {"report.html", "report.json", "case.json", "skin.ply", "skin.lut", "plan.mrk.json"})
        EXPECT_NE(sums.find(std::string("  ") + name + "\n"), std::string::npos) << name;
}

TEST_F(CommandsTest, AWarningIsPrintedThoughALaterStepFails) {
    std::ofstream(root() / "phantom.nii", std::ios::binary) << nifti_bytes(nifti_header({}), {});
    std::ofstream(root() / "far.mrk.json")
        << R"({"@schema": "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/markups-schema-v1.0.3.json#",
        "markups": [{"type": "Fiducial", "coordinateSystem": "LPS", "coordinateUnits": "mm",
        "controlPoints": [{"id": "1", "label": "B1", "position": [71, 4, 320], "description": "diameter_mm=7 depth_mm=6", "positionStatus": "defined"}]}]})";
    const auto run = run_planlight("prepare phantom.nii --plan far.mrk.json --voxel-mm 4 --out far", root());
    EXPECT_EQ(run.exit_code, 3) << run.err;
    EXPECT_NE(run.err.find("does not fit this patient"), std::string::npos) << run.err;
    EXPECT_NE(run.err.find("warning: the file does not say whether it is CT or MR"), std::string::npos) << run.err;
    EXPECT_FALSE(fs::exists(root() / "far"));
}

TEST_F(CommandsTest, ACaseIsCalledAsTheSiteCallsIt) {
    const std::string prepare = "prepare " + patient() + " --plan " + plan() + " --voxel-mm 4 ";
    const auto run =
        run_planlight(prepare + "--patient 'E. M.' --plan-name 'frontal defect' --plan-version 2 --out named", root());
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const std::string title = "E. M., frontal defect, version 2";
    EXPECT_NE(run.out.find(title), std::string::npos) << run.out;
    EXPECT_NE(read_text(root() / "named" / "report.html").find(title), std::string::npos);
    const auto review = run_planlight("review named --json", root());
    EXPECT_EQ(json::parse(review.out)["title"], title) << review.err;
    expect_one_clear_sentence(run_planlight(prepare + "--out long --title " + std::string(600, 't'), root()), 3,
                              "600 characters, more than 80");
    expect_one_clear_sentence(run_planlight(prepare + "--out named", root()), 3, "holds a case already");
    EXPECT_EQ(run_planlight(prepare + "--anonymous --patient EM --out never", root()).exit_code, 2);
    EXPECT_FALSE(fs::exists(root() / "never"));
}

/// Commands before the program that leave it so much address space, on one core and with one arena of memory: with more
/// threads it would take more of it for nothing.
std::string little_memory(int kib) {
    return "ulimit -v " + std::to_string(kib) +
           "; export MALLOC_ARENA_MAX=1; "
           "taskset -p -c $(taskset -p -c $$ | sed 's/.*: //; s/[-,].*//') $$ >/dev/null; ";
}

TEST_F(CommandsTest, WhereMemoryIsShortTheNeedIsSaid) {
    if (test::kUnderASanitizer) GTEST_SKIP() << "no limit means anything";
    const auto run = run_planlight("prepare " + patient() + " --plan " + plan() + " --voxel-mm 0.25 --out never",
                                   root(), little_memory(900000));
    EXPECT_TRUE(run.exit_code == 3 || run.exit_code == 7) << run.exit_code << run.err;
    EXPECT_NE(run.err.find("MiB"), std::string::npos) << run.err;
    EXPECT_FALSE(fs::exists(root() / "never"));
}

TEST_F(CommandsTest, WhereMemoryIsTooShortToDrawTheCaseIsMadeWithoutViewsAndSaysSo) {
    if (test::kUnderASanitizer) GTEST_SKIP() << "no limit means anything";
    // The renderer without a card would end the whole program, where it is given no memory.
    const auto run = run_planlight("prepare " + patient() + " --plan " + plan() + " --voxel-mm 4 --out viewless",
                                   root(), little_memory(1000000));
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_NE(run.err.find("no views of the head"), std::string::npos) << run.err;
    EXPECT_NE(run.err.find("MiB"), std::string::npos) << run.err;
    EXPECT_NE(read_text(root() / "viewless" / "report.html").find("no views of the head"), std::string::npos);
}

TEST_F(CommandsTest, AThresholdThatNothingIsMadeOfIsRefused) {
    const std::string prepare = "prepare " + patient() + " --plan " + plan() + " --voxel-mm 4 --out never";
    for (const char* level : {"0", "0.0", "-0"})
        expect_one_clear_sentence(run_planlight(prepare + " --threshold " + level, root()), 2, "between air and skin");
    EXPECT_EQ(run_planlight(prepare + " --threshold -300 --surface any.stl", root()).exit_code, 2);
    EXPECT_EQ(run_planlight(prepare + " --segment Bone", root()).exit_code, 2) << "of which surface?";
    EXPECT_FALSE(fs::exists(root() / "never"));
}

// Of the example's plan one thing is to be said: what its curve is between its points, which the file does not tell.
TEST_F(CommandsTest, TheExamplePlanRaisesNoWarningOnItsPatientButThatOfItsCurve) {
    const json report = json::parse(prepared().out);
    ASSERT_FALSE(report["warnings"].empty());
    for (const auto& said : report["warnings"]) {
        const std::string warning = said.get<std::string>();
        if (warning.find("\"Osteotomy\" runs straight between its 13 points") == 0) continue;
        for (const char* item : {"Osteotomy", "B1", "B2", "B3", "B4", "T1"})
            EXPECT_EQ(warning.find(item), std::string::npos) << warning;
    }
}

TEST_F(CommandsTest, PlanListsChecksAndConverts) {
    prepared();
    std::ofstream(root() / "t.csv")
        << "name,ex,ey,ez,tx,ty,tz,diameter_mm\nT1,-139.68,190.04,120.85,-132.49,134.29,99.87,2.5\n";
    expect_one_clear_sentence(run_planlight("plan t.csv --case case", root()), 3, "does not say its coordinate system");
    expect_one_clear_sentence(run_planlight("plan t.csv --frame LPS --case case", root()), 3, "T1");
    const auto run = run_planlight("plan t.csv --frame RAS --case case --out t.mrk.json --json", root());
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const json item = json::parse(run.out)["items"][0];
    EXPECT_EQ(item["kind"], "trajectory");
    EXPECT_LT(item["to_skin_mm"].get<double>(), 3);          // the example plan's own entry
    EXPECT_GT(item["left_of_middle_mm"].get<double>(), 10);  // at x = 139.68, the head's middle near 124
    const auto position = read_json(root() / "t.mrk.json")["markups"][0]["controlPoints"][0]["position"];
    EXPECT_EQ(position[0], 139.68);
    // An InVesalius project has no frame of reference: no RTSTRUCT can be written for it.
    expect_one_clear_sentence(run_planlight("plan t.mrk.json --case case --out t.dcm", root()), 3,
                              "frame of reference");
    EXPECT_FALSE(fs::exists(root() / "t.dcm"));
    ASSERT_EQ(run_planlight("plan " + plan() + " --case case --out all.vtp", root()).exit_code, 0);
    const auto again = run_planlight("plan all.vtp --case case --json", root());
    ASSERT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(json::parse(again.out)["items"].size(), 6U);
}

TEST_F(CommandsTest, AnotherProgramsSurfaceCanBeProjectedOn) {
    prepared();
    // The case's own skin, given back as a surface: the same case, without a segmentation.
    const std::string prepare = "prepare " + patient() + " --plan " + plan();
    const auto run = run_planlight(prepare + " --surface case/skin.ply --out on_skin --json", root());
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const json own = json::parse(prepared().out), result = json::parse(run.out);
    EXPECT_EQ(result["skin"], own["skin"]);
    EXPECT_EQ(result["case"], own["case"]);
    EXPECT_EQ(run_planlight("review on_skin --picture on_skin.png", root()).exit_code, 0);
    // The same with the frame not said, said wrongly, and said rightly.
    std::string ply = read_text(root() / "case" / "skin.ply");
    ply.replace(ply.find("SPACE=LPS"), 9, "no space ");
    std::ofstream(root() / "unsaid.ply", std::ios::binary) << ply;
    expect_one_clear_sentence(run_planlight(prepare + " --surface unsaid.ply --out never", root()), 3,
                              "does not say its coordinate system");
    expect_one_clear_sentence(run_planlight(prepare + " --surface unsaid.ply --surface-frame RAS --out never", root()),
                              3, "outside the volume");
    EXPECT_EQ(run_planlight(prepare + " --surface unsaid.ply --surface-frame LPS --out said", root()).exit_code, 0);
    EXPECT_FALSE(fs::exists(root() / "never"));
}

TEST_F(CommandsTest, ACaseOnAGivenSurfaceSpeaksOfNoThreshold) {
    prepared();
    const CommandRun run = run_planlight(
        "prepare " + patient() + " --plan " + plan() + " --surface case/skin.ply --out on_surface --json", root());
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const json report = read_json(root() / "on_surface" / "report.json");
    EXPECT_TRUE(report["surface_given"].get<bool>());
    EXPECT_FALSE(report.contains("threshold"));
    const std::string html = read_text(root() / "on_surface" / "report.html");
    EXPECT_EQ(html.find("Skin threshold"), std::string::npos);
    EXPECT_NE(html.find("as given"), std::string::npos);
    EXPECT_GT(json::parse(prepared().out)["edge_sigma_mm"].get<double>(), 0);
}

/// Whether any file of the folder holds the text, or is named so.
bool folder_says(const fs::path& folder, const std::string& text) {
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (read_text(entry.path()).find(text) != std::string::npos ||
            entry.path().filename().string().find(text) != std::string::npos)
            return true;
    return false;
}

TEST_F(CommandsTest, AnAnonymousCaseHoldsNoNameIdOrPathOfTheSeries) {
    const SeriesLook look{.patient = "Mustermann^Erika", .patient_id = "ID-4711", .description = "Kopf duenn"};
    write_series(synthetic_series({}, look), root() / "Mustermann");
    std::ofstream(root() / "Mustermann.fcsv")  // Slicer 3, which is noted with the file's name
        << "# Fiducial List file\n# numPoints = 1\n# columns = label,x,y,z,sel,vis\nB1,-71,-4,20,1,1\n";
    std::ofstream(root() / "hole.mrk.json")
        << R"({"@schema": "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/markups-schema-v1.0.3.json#",
        "markups": [{"type": "Fiducial", "coordinateSystem": "LPS", "coordinateUnits": "mm",
        "controlPoints": [{"id": "1", "label": "B1", "position": [71, 4, 20], "description": "diameter_mm=7 depth_mm=6", "positionStatus": "defined"}]}]})";
    const std::string frame_uid = "1.2.826.0.1.3680043.9.9999.5";
    const std::vector<std::string> identity = {"Mustermann", "Erika",   "ID-4711",      "Kopf duenn",
                                               look.uid,     frame_uid, root().string()};
    const auto named =
        run_planlight("prepare Mustermann --plan hole.mrk.json --voxel-mm 4 --out named_case --json", root());
    ASSERT_EQ(named.exit_code, 0) << named.err;
    EXPECT_TRUE(folder_says(root() / "named_case", look.uid)) << "the search finds what is there";
    const auto run = run_planlight(
        "prepare Mustermann --plan hole.mrk.json --voxel-mm 4 --out anonymous_case --anonymous --json", root());
    ASSERT_EQ(run.exit_code, 0) << run.err;
    for (const auto& text : identity) {
        EXPECT_FALSE(folder_says(root() / "anonymous_case", text)) << text;
        // No case holds more than the series' UIDs and description; a title for people is given by hand.
        const bool is_uid = text == look.uid || text == frame_uid || text == look.description;
        EXPECT_EQ(folder_says(root() / "named_case", text), is_uid) << text;
        EXPECT_EQ(run.out.find(text), std::string::npos) << text;
    }
    EXPECT_TRUE(folder_says(root() / "named_case", "Operator"));
    EXPECT_FALSE(folder_says(root() / "anonymous_case", "Operator")) << "who prepared it is a name, too";
    const auto listed = run_planlight(
        "prepare Mustermann --plan Mustermann.fcsv --voxel-mm 4 --out anonymous_list --anonymous --json", root());
    ASSERT_EQ(listed.exit_code, 0) << listed.err;
    EXPECT_TRUE(folder_says(root() / "anonymous_list", "is a list of Slicer 3")) << "it is noted";
    EXPECT_FALSE(folder_says(root() / "anonymous_list", "Mustermann"));
}

/// A closed cube of that edge round a point, as OBJ.
std::string cube(const Eigen::Vector3d& centre, double edge_mm, const std::string& header) {
    std::string text = header;
    for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector3d p =
            centre + edge_mm * Eigen::Vector3d((corner & 1) - 0.5, (corner >> 1 & 1) - 0.5, (corner >> 2) - 0.5);
        text += "v " + std::to_string(p.x()) + " " + std::to_string(p.y()) + " " + std::to_string(p.z()) + "\n";
    }
    return text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
}

// The trajectory of the example plan runs from (139.68, -190.04, 120.85) to (132.49, -134.29, 99.87).
TEST_F(CommandsTest, WhatComesNearARiskStructureIsSaidEverywhere) {
    const Eigen::Vector3d target(132.49, -134.29, 99.87);
    std::ofstream(root() / "Facial nerve.obj") << cube(target, 6, "# SPACE=LPS\n");
    std::ofstream(root() / "Orbit.obj") << cube(target + Eigen::Vector3d(0, 13, 0), 6, "");
    const std::string risk = " --risk 'Facial nerve.obj' --risk-frame LPS --risk Orbit.obj ";
    const auto run =
        run_planlight("prepare " + patient() + " --plan " + plan() + risk + "--voxel-mm 4 --json --out risky", root());
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_NE(run.err.find("it goes through Facial nerve"), std::string::npos) << run.err;
    const json result = json::parse(run.out);
    ASSERT_EQ(result["risk_structures"].size(), 2U);
    EXPECT_EQ(result["risk_structures"][1]["name"], "Orbit");
    const auto unnamed = run_planlight(
        "prepare " + patient() + " --plan " + plan() + risk + "--voxel-mm 4 --json --anonymous --out unnamed", root());
    ASSERT_EQ(unnamed.exit_code, 0) << unnamed.err;
    EXPECT_EQ(json::parse(unnamed.out)["risk_structures"][1]["name"], "structure 2");
    EXPECT_EQ(unnamed.err.find("Facial"), std::string::npos) << unnamed.err;
    EXPECT_FALSE(folder_says(root() / "unnamed", "Orbit")) << "files may be called after patients";
    const json way = result["items"][5]["risk"];
    EXPECT_EQ(way[0]["structure"], "Facial nerve");
    EXPECT_TRUE(way[0]["through"].get<bool>());
    EXPECT_FALSE(way[1]["through"].get<bool>());
    EXPECT_GT(way[1]["distance_mm"].get<double>(), 5);
    const std::string page = read_text(root() / "risky" / "report.html");
    EXPECT_NE(page.find("<span class=\"stop\">through Facial nerve</span>"), std::string::npos);
    const auto list = run_planlight("plan " + plan() + " --case risky --json", root());
    EXPECT_EQ(json::parse(list.out)["items"][5]["risk"], way) << "those of the case";
    const json review = json::parse(run_planlight("review risky --json", root()).out);
    EXPECT_EQ(review["items"][5]["risk"], way);
    EXPECT_EQ(review["risk_structures"], result["risk_structures"]);
    EXPECT_NE(result["case"], json::parse(prepared().out)["case"]);
    expect_one_clear_sentence(run_planlight("plan " + plan() + " --risk Orbit.obj", root()), 3,
                              "does not say its coordinate system");
    expect_one_clear_sentence(run_planlight("plan 'Facial nerve.obj'", root()), 3, "closed surface");
}

}  // namespace
}  // namespace planlight::test
