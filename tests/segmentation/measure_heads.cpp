// The skin of every head of a folder, as `planlight prepare` takes it: verdict, how it was checked, a picture sheet,
// and how far it lies off the skin that rays find; beside it the plain way (threshold, largest piece, fill). Compared
// with EXPECTED.tsv where the folder has one. measure_heads FOLDER [PICTURES] [--only WORD] [--variants]
// --variants: each head once more without a word in its header, along other axes, on a turned grid, with noise and
// shading, and without crown, chin or face; verdicts only.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "planning_io/files/image_file.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
#include "planning_io/volume/slice_faults.h"
#include "segmentation/outside_air.h"
#include "segmentation/skin_judgement.h"
#include "segmentation/skin_threshold.h"
#include "tests/segmentation/head_sheet.h"
#include "tests/segmentation/head_variants.h"
#include "tests/segmentation/off_skin.h"
#include "tests/segmentation/ray_skin.h"

namespace planlight::test {
namespace {

namespace fs = std::filesystem;

struct Row {
    std::string verdict = "refuse", why;
    double ml = NAN, off_percent = NAN, plain_off_percent = NAN, seconds = 0;
    SkinJudgement judged;
    SkinMask mask;
    std::array<double, 3> jumps{}, exchanges{};  ///< `largest_slice_jumps`, `best_slice_exchanges`
};

/// Threshold, largest piece, fill.
double plain_off_percent(Volume volume, const std::vector<Eigen::Vector3d>& points) {
    try {
        SkinMask mask;
        mask.threshold = skin_threshold(volume);
        mask.body.resize(volume.values.size());
        for (std::size_t v = 0; v < mask.body.size(); ++v)
            mask.body[v] = static_cast<double>(volume.values[v]) >= mask.threshold;
        const VoxelGrid grid = grid_of(volume);
        mask.body = outside_air(largest_piece(std::move(mask.body), grid).mask, grid);
        for (auto& v : mask.body) v = !v;
        volume.modality.clear();
        return off_skin(points, triangulate_skin(volume, mask)).percent();
    } catch (const Error&) {
        return NAN;
    }
}

std::string verdict_of(const SkinJudgement& judged) {
    const auto is_cut = [](const SkinDoubt& d) { return d.finding.starts_with("The volume ends"); };
    const auto cuts = std::count_if(judged.doubts.begin(), judged.doubts.end(), is_cut);
    if (static_cast<std::size_t>(cuts) < judged.doubts.size()) return "warn";
    return cuts > 0 ? "skin+cut" : "skin";
}

/// The verdict of a volume, without rays.
Row judge(const Volume& volume) {
    Row row;
    try {
        row.mask = segment_skin(volume);
        row.judged = judge_skin(volume, row.mask, triangulate_skin(volume, row.mask));
        row.ml = row.mask.volume_ml;
        refuse_implausible(row.judged);
        row.verdict = verdict_of(row.judged);
        for (const SkinDoubt& d : row.judged.doubts) row.why += (row.why.empty() ? "" : "; ") + d.finding;
    } catch (const Error& error) {
        row.why = error.what();
    }
    return row;
}

Row measure(const fs::path& path, const fs::path& pictures) {
    Row row;
    try {
        const Volume volume = read_volume(path, {}, SliceGaps::resampled);
        const auto began = std::chrono::steady_clock::now();
        row.mask = segment_skin(volume);
        const TriangleMesh skin = triangulate_skin(volume, row.mask);
        row.judged = judge_skin(volume, row.mask, skin);
        row.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
        row.jumps = largest_slice_jumps(volume);
        row.exchanges = best_slice_exchanges(volume);
        row.ml = row.mask.volume_ml;
        const auto points = ray_skin(volume);
        const OffSkin off = off_skin(points, skin);
        if (!pictures.empty())
            write_png(head_sheet(volume, skin, off.off), pictures / (path.filename().string() + ".png"));
        refuse_implausible(row.judged);
        row.verdict = verdict_of(row.judged);
        for (const SkinDoubt& d : row.judged.doubts) row.why += (row.why.empty() ? "" : "; ") + d.finding;
        row.off_percent = off.percent();
        row.plain_off_percent = plain_off_percent(volume, points);
    } catch (const Error& error) {
        row.why = error.what();
    }
    return row;
}

std::map<std::string, std::string> expected_in(const fs::path& folder) {
    std::map<std::string, std::string> expected;
    std::ifstream file(folder / "EXPECTED.tsv");
    for (std::string line; std::getline(file, line);) {
        std::istringstream fields(line);
        std::string name, verdict;
        if (std::getline(fields, name, '\t') && std::getline(fields, verdict, '\t')) expected[name] = verdict;
    }
    return expected;
}

/// A warning does for a cut and for a refusal expected as one ("warn"); a refusal is right where "warn" was expected.
bool is_right(const std::string& verdict, const std::string& expected, bool cut) {
    if (expected == "refuse") return verdict == "refuse" || (cut && verdict == "warn");
    if (expected == "warn") return verdict != "skin";
    if (cut) return verdict != "skin";  // crown, chin or face: said, or not taken
    if (expected == "skin+cut") return verdict == "skin+cut" || verdict == "warn";
    return verdict != "refuse";
}

/// Prints each variant's verdict; returns how many are not as expected.
int measure_variants(const fs::path& head, const std::string& expected) {
    const fs::path folder = fs::temp_directory_path() / fmt::format("planlight_heads_{}", getpid());
    std::vector<HeadVariant> all;
    std::string refused;
    try {
        const Volume volume = read_volume(without_words(head, folder), {}, SliceGaps::resampled);
        all = variants_of(volume);
        all.insert(all.begin(), {"no words", volume});
    } catch (const Error& error) {
        refused = error.what();
    }
    fs::remove_all(folder);
    int wrong = 0;
    for (const HeadVariant& variant : all) {
        const Row row = judge(variant.volume);
        const bool right = expected.empty() || is_right(row.verdict, expected, variant.cut);
        wrong += !right;
        fmt::print("{}\t{}\t{}{}\t{}\t{:.0f}\t{}\n", head.filename().string(), variant.name, row.verdict,
                   right ? "" : " WRONG", expected, row.ml, row.why);
        std::fflush(stdout);
    }
    if (all.empty()) fmt::print("{}\tnot read\trefuse\t{}\t\t{}\n", head.filename().string(), expected, refused);
    return wrong;
}

}  // namespace
}  // namespace planlight::test

int main(int argc, char** argv) {
    using namespace planlight::test;
    if (argc < 2) {
        fmt::print(stderr, "measure_heads FOLDER [PICTURES] [--only WORD] [--variants]\n");
        return 2;
    }
    namespace fs = std::filesystem;
    const fs::path folder = argv[1], pictures = argc > 2 && argv[2][0] != '-' ? argv[2] : "";
    std::string only;
    bool variants = false;
    for (int a = 2; a < argc; ++a) {
        if (std::string(argv[a]) == "--only" && a + 1 < argc) only = argv[++a];
        if (std::string(argv[a]) == "--variants") variants = true;
    }
    if (!pictures.empty()) fs::create_directories(pictures);
    const auto expected = expected_in(folder);
    std::vector<fs::path> heads;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() != ".tsv" && entry.path().filename().string().find(only) != std::string::npos)
            heads.push_back(entry.path());
    std::sort(heads.begin(), heads.end());
    int wrong = 0;
    if (variants) {
        fmt::print("head\tvariant\tverdict\texpected\tml\twhy\n");
        for (const auto& head : heads) {
            const auto known = expected.find(head.filename().string());
            wrong += measure_variants(head, known == expected.end() ? "" : known->second);
        }
        fmt::print("{} heads, {} variants not as expected\n", heads.size(), wrong);
        return wrong == 0 ? 0 : 6;
    }
    fmt::print(
        "head\tverdict\texpected\tml\tthreshold\tball mm\tlayered\tnose mm\tblur mm\tunsure\tsigma "
        "mm\techo\tbeside mm\tjumps\texchange\toff "
        "> 2 mm %\tplain off %\ts\twhy\n");
    for (const auto& head : heads) {
        const std::string name = head.filename().string();
        const Row row = measure(head, pictures);
        const auto known = expected.find(name);
        const bool right = known == expected.end() || is_right(row.verdict, known->second, false);
        wrong += !right;
        fmt::print(
            "{}\t{}{}\t{}\t{:.0f}\t{:.4g}\t{:.0f}\t{:.2f}\t{:.0f}\t{:.1f}\t{:.3f}\t{:.2f}\t{:.2f}\t{:.0f}\t{:.1f}\t"
            "{:.2f}\t{:.2f}\t{:.2f}\t{:.1f}\t{}\n",
            name, row.verdict, right ? "" : " WRONG", known == expected.end() ? "-" : known->second, row.ml,
            row.mask.threshold_said, row.judged.ball_radius_mm, row.judged.layered_share, row.judged.nose_mm,
            row.judged.edge_blur_mm, row.mask.unsure_share, row.judged.noise_sigma_mm, row.judged.echo,
            row.judged.beside_mm, fmt::join(row.jumps, " "),
            *std::max_element(row.exchanges.begin(), row.exchanges.end()), row.off_percent, row.plain_off_percent,
            row.seconds, row.why);
        std::fflush(stdout);
    }
    fmt::print("{} heads, {} not as expected\n", heads.size(), wrong);
    return wrong == 0 ? 0 : 6;
}
