// Is the patient found among cloth, hands and instruments, and is what is not the patient refused there?
// measure_draped [TRIALS [SEED]] [--ch2 FILE] [--mannequin FILE] [--ct-head FOLDER] [--volume FILE]... [--log FILE]
// [--to-refuse] Default 1000 trials, seed 1. With a log the run can be cut and goes on; the tables are of all trials in
// the log. One trial in five must be refused: the face of another patient, a mirrored face, or the cloth without
// anybody under it; with --to-refuse all are such.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "tests/registration/matching/draped_scene.h"
#include "tests/registration/matching/trial_counts.h"
#include "tests/registration/matching/trial_heads.h"
#include "tests/registration/matching/trial_options.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

constexpr const char* kOther = "another patient";
constexpr const char* kMirrored = "mirrored face";
constexpr const char* kNobody = "cloth, and nobody under it";

/// The most anterior skin, and from there to behind the bridge of the nose.
Vector3d face_of(const TrialSurface& head) {
    const TriangleMesh& mesh = head.mesh();
    Vector3d nose = Vector3d::Constant(1e9);
    for (std::size_t i = 0; i < mesh.vertices_in_ct.size(); ++i)
        if ((mesh.flags.empty() || mesh.flags[i] == kSkin) && mesh.vertices_in_ct[i].y() < nose.y())
            nose = mesh.vertices_in_ct[i];
    return nose + Vector3d(0, 80, 20);
}

TrialSurface mirrored(const TrialSurface& head) {
    TriangleMesh mesh = head.mesh();
    const double middle = head.middle_in_ct().x();
    for (Vector3d& p : mesh.vertices_in_ct) p.x() = 2 * middle - p.x();
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    return TrialSurface(std::move(mesh));
}

DrapedSceneSettings drawn(unsigned seed, std::mt19937& random) {
    std::uniform_real_distribution<double> unit;
    const auto between = [&](double low, double high) { return low + (high - low) * unit(random); };
    DrapedSceneSettings scene;
    scene.draping = drapings()[seed % drapings().size()].name;
    const double azimuth = between(-0.9, 0.9), up = between(-0.2, 0.6);
    scene.from_in_ct = Vector3d(std::sin(azimuth) * std::cos(up), -std::cos(azimuth) * std::cos(up), std::sin(up));
    scene.face_in_ct = Vector3d(between(-20, 20), 0, between(-20, 20));
    scene.roll = between(-std::numbers::pi, std::numbers::pi);
    scene.window_mm = between(240, 400);
    scene.opening_mm = between(95, 170);
    scene.points = static_cast<int>(between(15000, 40000));
    scene.noise_mm = between(0.1, 0.6);
    scene.stray_share = between(0, 0.05);
    scene.seed = seed;
    return scene;
}

TrialRecord run(const std::vector<TrialHead>& heads, unsigned seed) {
    std::mt19937 random(seed * 7919U);
    DrapedSceneSettings settings = drawn(seed, random);
    const std::size_t at = random() % heads.size();
    const TrialHead& head = heads[at];
    const TrialHead* scanned = &head;
    TrialRecord record;
    record.seed = seed;
    record.head = head.name;
    record.view = settings.draping;
    record.kind = "patient";
    const unsigned turn = seed / static_cast<unsigned>(drapings().size());
    const bool must_be_refused = turn % 5 == 4;
    record.right_object = !must_be_refused;
    DrapedScene scene;
    const auto shot = [&](const TrialSurface& surface) {
        settings.face_in_ct += face_of(surface);
        scene = draped_scene(surface, settings);
    };
    if (!must_be_refused) {
        shot(head.surface);
    } else if (turn / 5 % 3 == 0) {
        record.kind = kOther;
        do scanned = &heads[random() % heads.size()];
        while (scanned->name.substr(0, 4) == head.name.substr(0, 4));
        shot(scanned->surface);
    } else if (turn / 5 % 3 == 1) {
        record.kind = kMirrored;
        shot(mirrored(head.surface));
    } else {
        record.kind = kNobody;
        settings.without_head = true;
        shot(head.surface);
    }
    const TrialScan& scan = scene.scan;
    record.width_mm = scene.skin_width_mm;
    record.noise_mm = settings.noise_mm;
    record.strays = settings.stray_share;
    record.drape = static_cast<double>(scan.drape_points) /
                   std::max(1., static_cast<double>(scan.drape_points + scan.bare_points));
    record.movement = "none";
    run_trial(scan, head.lut, record);
    return record;
}

void print_row(const std::string& name, const std::vector<TrialRecord>& all, const TrialsThat& in) {
    const TrialCounts row(all, in);
    if (row.empty()) return;
    const auto error =
        row.target_mm(&TrialRecord::final, [](const TrialRecord& r) { return r.found_finally() && r.verdict < 2; });
    const auto seconds = row.values(&TrialRecord::initial_s), processor_s = row.values(&TrialRecord::processor_s);
    fmt::print(
        "| {} | {} | {:.1f} % | {} / {} / {} | {} / {} | {:.2f}, {:.2f}, {:.2f} | {:.2f}, {:.2f} | {:.2f}, {:.2f} |\n",
        name, row.trials.size(), row.percent(row.found_finally), row.verdicts[0], row.verdicts[1], row.verdicts[2],
        row.wrong[0], row.wrong[1], quantile(error, 0.5), quantile(error, 0.95), quantile(error, 1),
        quantile(seconds, 0.5), quantile(seconds, 0.99), quantile(processor_s, 0.5), quantile(processor_s, 0.99));
}

void print_table(const std::vector<TrialRecord>& all) {
    fmt::print(
        "| scenes | number | found: within 3 degrees, 5 mm in the end | yes / ask / no | wrong (> 5 mm, or not this "
        "patient): yes / ask | "
        "error at targets of those found and not refused, mm: median, 95 %, worst | initial match, s by the wall: "
        "median, 99 % | "
        "processor s in all: median, 99 % |\n|---|---|---|---|---|---|---|---|\n");
    const TrialsThat patient = [](const TrialRecord& r) { return r.right_object; };
    const TrialsThat within = [](const TrialRecord& r) { return r.right_object && r.drape <= 0.8 && r.width_mm >= 90; };
    const auto looked_at = [](const TrialRecord& r, bool yes) {
        for (const Draping& d : drapings())
            if (d.name == r.view) return d.looked_at == yes;
        return false;
    };
    print_row("**skin at least 90 mm wide, at most 80 % covered**", all, within);
    print_row("of these, kinds looked at", all, [&](const TrialRecord& r) { return within(r) && looked_at(r, true); });
    print_row("of these, kinds kept aside", all,
              [&](const TrialRecord& r) { return within(r) && looked_at(r, false); });
    for (const Draping& d : drapings())
        print_row(d.name, all, [&](const TrialRecord& r) { return within(r) && r.view == d.name; });
    std::set<std::string> heads;
    for (const TrialRecord& r : all) heads.insert(r.head);
    for (const std::string& head : heads)
        print_row(head, all, [&](const TrialRecord& r) { return within(r) && r.head == head; });
    for (const auto& [low, high] : {std::pair{0., 0.5}, {0.5, 0.65}, {0.65, 0.8}, {0.8, 1.}})
        print_row(fmt::format("covered {:.0f} to {:.0f} %, any width", 100 * low, 100 * high), all,
                  [&, low = low, high = high](const TrialRecord& r) {
                      return patient(r) && r.drape > low && r.drape <= high;
                  });
    for (const auto& [low, high] : {std::pair{0., 90.}, {90., 110.}, {110., 140.}, {140., 400.}})
        print_row(fmt::format("skin {:.0f} to {:.0f} mm wide, any cover", low, high), all,
                  [&, low = low, high = high](const TrialRecord& r) {
                      return patient(r) && r.width_mm > low && r.width_mm <= high;
                  });
    for (const char* kind : {kOther, kMirrored, kNobody})
        print_row(kind, all, [&](const TrialRecord& r) { return r.kind == kind; });
}

void print_misses(const std::vector<TrialRecord>& all) {
    fmt::print("\nNot found or not sure, and wrong ones that were accepted:\n");
    for (const TrialRecord& r : all)
        if ((r.right_object && (!r.found_finally() || r.verdict != 0)) || (r.verdict < 2 && r.wrong()))
            fmt::print(
                "  seed {}: {}, {}, {}, skin {:.0f} mm, {:.0f} % covered, {} points, noise {:.1f}: {:.1f} mm off, "
                "verdict {}: {}\n",
                r.seed, r.kind, r.head, r.view, r.width_mm, 100 * r.drape, r.points, r.noise_mm, r.final.target_mm,
                r.verdict, r.reasons);
}

}  // namespace
}  // namespace planlight::test

int main(int argc, char** argv) {
    using namespace planlight::test;
    TrialOptions options = trial_options(argc, argv, 1000);
    for (const char* name : {"heads/head_11.nii.gz", "heads/head_21.nii.gz"})
        if (const auto file = third_party_data(name)) options.files.volumes.push_back(*file);
    const std::vector<TrialHead> heads = trial_heads(options.files);
    // Five times the kinds of drapings are a turn, and the last fifth of each must be refused.
    const auto kinds = static_cast<unsigned>(drapings().size());
    const auto scene_of = [&](unsigned seed) {
        return options.to_refuse ? kinds * (5 * (seed / kinds) + 4) + seed % kinds : seed;
    };
    const auto all = run_trials(options, [&](unsigned seed) { return run(heads, scene_of(seed)); });
    print_table(all);
    print_misses(all);
}
