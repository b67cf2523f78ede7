#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <regex>
#include <set>
#include <vector>

#include "planning_io/plan/plan_import.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
#include "tests/planning_io/plan_cases.h"
#include "tests/planning_io/volume_cases.h"
#include "tests/support/analytic_head.h"
#include "tests/support/test_data.h"

/// intake_table FOLDER_OR_FILE...: gives everything found there to read_volume or import_plan, then every synthetic
/// case, and prints a Markdown table: what, accepted (with its geometry) or refused, and the sentence.
namespace planlight::test {
namespace {

namespace fs = std::filesystem;

struct Row {
    std::string what;
    bool accepted = false;
    std::string sentence;
};

/// Without the path that the row names already; the rest of a path below `root` as "DATA".
std::string one_line(std::string text, const std::string& path, const std::string& root) {
    if (text.starts_with(path + ": ")) text.erase(0, path.size() + 2);
    for (std::size_t at; !root.empty() && (at = text.find(root)) != std::string::npos;)
        text.replace(at, root.size(), "DATA");
    for (std::size_t at; (at = text.find(":\n")) != std::string::npos;) text.erase(at + 1, 1);
    std::string line;
    for (const char c : text) line += c == '\n' ? "; " : c == '|' ? "/" : std::string(1, c);
    return line.size() > 420 ? line.substr(0, 417) + "..." : line;
}

/// The geometry in words: voxels, spacing, which way i, j and k run, tilt.
std::string words_of(const Volume& v) {
    std::string axes;
    for (int a = 0; a < 3; ++a) {
        Eigen::Index along = 0;
        v.ct_from_voxel.linear().col(a).cwiseAbs().maxCoeff(&along);
        axes += (v.ct_from_voxel.linear().col(a)[along] > 0 ? "LPS" : "RAI")[along];
    }
    const Eigen::Vector3d s = v.spacing_mm();
    std::string text =
        fmt::format("{}{}, {} x {} x {} voxels of {:.3g} x {:.3g} x {:.3g} mm, axes towards {}", v.modality,
                    v.is_hu ? " in HU" : "", v.size[0], v.size[1], v.size[2], s.x(), s.y(), s.z(), axes);
    for (const auto& note : v.notes) text += "; " + note;
    return text;
}

Row volume_row(const std::string& what, const fs::path& path, const std::string& series, const std::string& root) {
    try {
        return {what, true, words_of(read_volume(path, series))};
    } catch (const Error& e) {
        return {what, false, one_line(std::string(e.what()) + ". " + e.remedy, path.string(), root)};
    }
}

/// "1 trajectory, 2 boreholes" and the notes.
std::string words_of(const PlanImport& read) {
    std::string text;
    const auto add = [&](std::size_t count, const char* one, const char* more) {
        if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, count == 1 ? one : more);
    };
    add(read.plan.trajectories.size(), "trajectory", "trajectories");
    add(read.plan.boreholes.size(), "borehole", "boreholes");
    add(read.plan.osteotomy_lines.size(), "osteotomy line", "osteotomy lines");
    add(read.plan.cut_planes.size(), "cut plane", "cut planes");
    if (text.empty()) text = "nothing that can be shown";
    for (const auto& note : read.notes) text += "; " + note;
    return text;
}

Row plan_row(const std::string& what, const fs::path& path, const std::string& root,
             const PlanImportSettings& settings = {}) {
    try {
        return {what, true, one_line(words_of(import_plan(path, settings)), path.string(), root)};
    } catch (const Error& e) {
        return {what, false, one_line(std::string(e.what()) + ". " + e.remedy, path.string(), root)};
    }
}

/// A plan as it is; where only its frame is not said, once more with the frame said.
void add_plan_rows(std::vector<Row>& rows, const std::string& what, const fs::path& path, const std::string& root) {
    rows.push_back(plan_row(what, path, root));
    if (rows.back().sentence.find("does not say its coordinate system") != std::string::npos)
        rows.push_back(plan_row(what + " `--frame RAS`", path, root, {Space::ras, {}}));
}

std::vector<Row> synthetic(const std::vector<PlanCase>& cases) {
    std::vector<Row> rows;
    for (const auto& c : cases) {
        const TemporaryFolder folder;
        rows.push_back(plan_row(c.name, c.make(folder.path()), folder.path().string(), c.settings));
    }
    return rows;
}

/// The checks of a plan against its patient.
std::vector<Row> on_head() {
    const SkinSurface skin(analytic_head_mesh(4));
    std::vector<Row> rows;
    for (const auto& c : plans_on_head()) {
        const PlanVerdict verdict = check_plan(c.plan, skin, box_of_head());
        std::string sentence =
            verdict.stops.empty() ? fmt::format("a median of {:.1f} mm from the skin", verdict.median_to_skin_mm) : "";
        for (const auto& stop : verdict.stops) sentence += (sentence.empty() ? "" : "; ") + stop;
        rows.push_back({c.name, verdict.stops.empty(), one_line(sentence, "", "")});
    }
    return rows;
}

bool is_plan_place(const fs::path& path) {
    return path.string().find("/plans/") != std::string::npos;
}

bool is_text(const fs::path& path) {
    const std::string e = path.extension().string();
    return e == ".md" || e == ".txt" || e == ".dump" || e == ".py" ||
           path.filename().string().find("LICENSE") != std::string::npos;
}

/// Folders whose files belong together are one thing; others are looked into.
void collect(const fs::path& path, std::vector<fs::path>& things) {
    if (!fs::is_directory(path)) return things.push_back(path);
    std::set<fs::path> files, folders;
    for (const auto& entry : fs::directory_iterator(path))
        (entry.is_directory() ? folders : files).insert(entry.path());
    std::erase_if(files, is_text);
    const bool series = folders.empty() && path.filename() != "single_files" && !is_plan_place(path / "x") &&
                        path.string().find("/scans") == std::string::npos;
    if (series && !files.empty()) return things.push_back(path);
    for (const auto& file : files) things.push_back(file);
    for (const auto& folder : folders) collect(folder, things);
}

void print(const std::string& title, const std::vector<Row>& rows) {
    const auto accepted = std::count_if(rows.begin(), rows.end(), [](const Row& r) { return r.accepted; });
    fmt::print("\n## {}: {} accepted, {} refused\n\n| what | | sentence |\n|---|---|---|\n", title, accepted,
               rows.size() - static_cast<std::size_t>(accepted));
    std::vector<std::pair<Row, int>> groups;
    std::map<std::string, std::size_t> place;  // by the sentence without its numbers
    for (const Row& row : rows) {
        const auto [at, is_new] = place.emplace(
            (row.accepted ? "+" : "-") + std::regex_replace(row.sentence, std::regex("[0-9.]+"), "#"), groups.size());
        if (is_new) groups.emplace_back(row, 0);
        ++groups[at->second].second;
    }
    for (const auto& [row, count] : groups)
        fmt::print("| {}{} | {} | {} |\n", row.what, count > 1 ? fmt::format(" and {} alike", count - 1) : "",
                   row.accepted ? "accepted" : "refused", row.sentence);
}

std::vector<Row> synthetic(const std::vector<VolumeCase>& cases) {
    std::vector<Row> rows;
    for (const auto& c : cases) {
        const TemporaryFolder folder;
        rows.push_back(volume_row(c.name, c.make(folder.path()), c.series, folder.path().string()));
        std::cerr << '.' << std::flush;
    }
    return rows;
}

constexpr const char* kHead =
    R"(# What is taken in, and what is refused

Made by one command; nothing below was written by hand:

    build/tests/planning_io/intake_table DATA/ct DATA/mri DATA/dicom_bad DATA/plans DATA/scans Cranium.inv3 ch2.nii.gz > planning_io/INTAKE.md

`Cranium.inv3` is the example patient (Debian's `invesalius-examples`), `ch2.nii.gz` of Debian's `mricron-data`. DATA is a collection of
public files, kept outside of this repository: `ct` from Slicer/Slicer (Testing/Data/Input/CTHeadAxialDicom) and neurolabusc/dcm_qa_ct
(In/Philips), `mri` from neurolabusc/dcm_qa_decubitus, `dicom_bad` from icometrix/dicom2nifti and pydicom/pydicom (each of its single
files is given alone), `plans` from Slicer, SlicerMorph, afids, SlicerRt, dicompyler-core and pydicom, `scans` from Rvcg, VTKData and
OpenGR (point clouds: none is a volume). The synthetic volumes are those of the tests; a sound one is also compared with its phantom
there, value by value. Axes: the way i, j and k run, to the (L)eft, (P)osterior, (S)uperior and so on. A plan whose file does not say its
frame stands twice: as it is, and with `--frame RAS`. What differs in numbers only is one line.
)";

}  // namespace
}  // namespace planlight::test

int main(int argc, char** argv) {
    using namespace planlight::test;
    std::vector<Row> volumes, plans;
    for (int a = 1; a < argc; ++a) {
        const std::string given = fs::path(argv[a]).lexically_normal().string();
        const std::string root = fs::path(given).parent_path().string();
        std::vector<fs::path> things;
        collect(given, things);
        for (const auto& thing : things) {
            const std::string what = "DATA/" + fs::relative(thing, root).string();
            const TemporaryFolder alone;
            if (thing.parent_path().filename() == "single_files") {  // other people's files have nothing to do with it
                fs::copy_file(thing, alone.path() / thing.filename());
                volumes.push_back(volume_row(what, alone.path() / thing.filename(), "", alone.path().string()));
            } else if (is_plan_place(thing / "x")) {
                add_plan_rows(plans, what, thing, root);
            } else {
                volumes.push_back(volume_row(what, thing, "", root));
            }
            std::cerr << '.' << std::flush;
        }
    }
    fmt::print("{}", kHead);
    if (!volumes.empty()) print("Volumes of other people", volumes);
    if (!plans.empty()) print("Plans of other people", plans);
    print("Synthetic volumes that are sound", synthetic(sound_volumes()));
    print("Synthetic volumes that are not", synthetic(spoilt_volumes()));
    print("Synthetic plans that are sound", synthetic(sound_plans()));
    print("Synthetic plans that are not", synthetic(spoilt_plans()));
    print("Plans for the analytic head of the tests, read without fault and held against its skin", on_head());
    return 0;
}
