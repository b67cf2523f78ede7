// Is the patient found, from any pose? Random scans of several heads, matched without help.
// measure_initial_match [TRIALS [SEED]] [--ch2 FILE] [--mannequin FILE] [--ct-head FOLDER] [--log FILE]
// [--plain]
// Default 2000 trials, seed 1. With a log the run can be cut and goes on; the tables are of all trials in the log.
// --plain: what a user's ordinary scan is: at least 140 mm wide, at most 25 % strays, no cloth, skin still or (half of
// them) moved by 0.5 to 1 mm; every one that is not a yes is listed with its reasons.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <numbers>
#include <random>

#include "tests/registration/matching/moved_skin.h"
#include "tests/registration/matching/trial_counts.h"
#include "tests/registration/matching/trial_heads.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

/// Where a scan is made from, degrees: from the front, towards the head's left; up.
struct View {
    std::string name;
    double azimuth_deg, up_deg;
};
const std::vector<View> kViews{
    {"front", 0, 5}, {"half side", 45, 10}, {"side", 90, 5}, {"back", 170, 15}, {"front from above", 10, 45}};

TrialRecord run(const std::vector<TrialHead>& heads, unsigned seed, bool plain) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit, both(-1, 1);
    const auto between = [&](double low, double high) { return low + (high - low) * unit(random); };
    const TrialHead& head = heads[seed % heads.size()];
    const View& view = kViews[random() % kViews.size()];
    const double other_side = random() % 2 == 0 ? 1 : -1;
    const double azimuth = (other_side * view.azimuth_deg + 15 * both(random)) * std::numbers::pi / 180;
    const double up = (view.up_deg + 12 * both(random)) * std::numbers::pi / 180;
    TrialScanSettings scan;
    scan.from_in_ct = Vector3d(std::sin(azimuth) * std::cos(up), -std::cos(azimuth) * std::cos(up), std::sin(up));
    scan.roll = std::numbers::pi * both(random);
    scan.aside_mm = {20 * both(random), 20 * both(random)};
    scan.width_mm = between(plain ? 140 : 92, 250);
    scan.noise_mm = between(0, 1);
    scan.stray_share = between(0, plain ? 0.25 : 0.4);
    scan.drape_share = unit(random) < 0.5 || plain ? 0 : between(0, 0.4);
    scan.drape_height_mm = between(5, 30);
    const auto& movements = skin_movements();
    const bool moves = unit(random) < (plain ? 0.5 : 0.75);
    scan.movement = movements[random() % movements.size()].name;
    scan.movement_mm = moves ? between(0.5, plain ? 1 : 2) : 0;
    scan.seed = seed;
    TrialRecord record;
    record.seed = seed;
    record.kind = "random";
    record.head = head.name;
    record.view = view.name;
    record.width_mm = scan.width_mm;
    record.noise_mm = scan.noise_mm;
    record.strays = scan.stray_share;
    record.drape = scan.drape_share;
    record.movement = moves ? scan.movement : "none";
    record.movement_mm = scan.movement_mm;
    run_trial(trial_scan(head.surface, scan), head.lut, record);
    return record;
}

void print_row(const std::string& name, const std::vector<TrialRecord>& all, const TrialsThat& in) {
    const TrialCounts row(all, in);
    if (row.empty()) return;
    const TrialsThat found = [](const TrialRecord& r) { return r.found(); };
    const auto before = row.target_mm(&TrialRecord::initial, found), after = row.target_mm(&TrialRecord::final, found);
    const auto good =
        static_cast<std::size_t>(std::count_if(after.begin(), after.end(), [](double mm) { return mm < 2; }));
    const auto initial_s = row.values(&TrialRecord::initial_s), processor_s = row.values(&TrialRecord::processor_s);
    fmt::print(
        "| {} | {} | {:.1f} / {:.1f} % | {:.1f} % | {:.0f} / {:.0f} / {:.0f} % | {} / {} | {:.2f}, {:.2f} | {:.2f}, "
        "{:.2f} | {:.2f}, {:.2f} | {:.2f} |\n",
        name, row.trials.size(), row.percent(row.found), row.percent(row.found_finally), row.percent(good),
        row.percent(row.verdicts[0]), row.percent(row.verdicts[1]), row.percent(row.verdicts[2]), row.wrong[0],
        row.wrong[1], quantile(before, 0.5), quantile(before, 0.95), quantile(after, 0.5), quantile(after, 0.95),
        quantile(initial_s, 0.5), quantile(initial_s, 0.99), quantile(processor_s, 0.5));
}

void print_table(const std::vector<TrialRecord>& all) {
    fmt::print(
        "| trials | number | found (within 3 degrees, 5 mm): before / after the fine match | found, and < 2 mm at "
        "targets | yes / ask / no | wrong (> "
        "5 mm): yes / ask | "
        "error of those found, mm, before: median, 95 % | after | initial match, s by the wall: median, 99 % | "
        "processor s in all: median |\n"
        "|---|---|---|---|---|---|---|---|---|---|\n");
    const auto goal = [](const TrialRecord& r) { return r.width_mm >= 140 && r.movement_mm <= 1; };
    print_row("**at least 140 mm, at most 1 mm moved**", all, goal);
    print_row("same, at most 25 % strays, no cloth", all,
              [&](const TrialRecord& r) { return goal(r) && r.strays <= 0.25 && r.drape == 0; });
    print_row("all", all, [](const TrialRecord&) { return true; });
    print_row("all but the mannequin, who is nearly his own mirror image", all,
              [](const TrialRecord& r) { return r.head != "mannequin"; });
    print_row("the same, and not from the back", all,
              [](const TrialRecord& r) { return r.head != "mannequin" && r.view != "back"; });
    const auto each = [&](const std::string& title, auto key, bool of_goal) {
        std::map<std::string, bool> names;
        for (const TrialRecord& r : all) names[key(r)] = true;
        for (const auto& [name, unused] : names)
            print_row(title + name, all, [&](const TrialRecord& r) { return key(r) == name && (!of_goal || goal(r)); });
    };
    const auto within = [](double value, std::vector<double> edges, const std::string& unit) {
        std::size_t i = 1;
        while (i + 1 < edges.size() && value >= edges[i]) ++i;
        return fmt::format("{:.3g} to {:.3g} {}", edges[i - 1], edges[i], unit);
    };
    each(
        "", [](const TrialRecord& r) { return r.head; }, false);
    each(
        "goal's, ", [](const TrialRecord& r) { return r.head; }, true);
    each(
        "goal's, from: ", [](const TrialRecord& r) { return r.view; }, true);
    each(
        "wide ",
        [&](const TrialRecord& r) {
            return within(r.width_mm, {90, 115, 140, 170, 200, 250}, "mm");
        },
        false);
    each(
        "moved ",
        [&](const TrialRecord& r) {
            return within(r.movement_mm, {0, 0.5, 1, 1.5, 2}, "mm");
        },
        false);
    each(
        "moved by ", [&](const TrialRecord& r) { return r.movement; }, false);
    each(
        "strays ",
        [&](const TrialRecord& r) {
            return within(100 * r.strays, {0, 10, 25, 40}, "%");
        },
        false);
    each(
        "under a cloth ",
        [&](const TrialRecord& r) {
            return r.drape == 0 ? "0" : within(100 * r.drape, {0, 10, 25, 40}, "%");
        },
        false);
}

void print_misses(const std::vector<TrialRecord>& all, bool plain) {
    fmt::print("\nOf the goal's trials, not found{} or wrong with a yes:\n", plain ? ", not a yes," : "");
    for (const TrialRecord& r : all)
        if ((r.width_mm >= 140 && r.movement_mm <= 1 && !r.found()) || (plain && r.verdict != 0) ||
            (r.verdict == 0 && r.wrong()))
            fmt::print(
                "  seed {}: {}, {}, {:.0f} mm, {} points, noise {:.1f}, strays {:.0f} %, cloth {:.0f} %, {} {:.1f} mm: "
                "{:.1f} mm off, verdict {}: {}\n",
                r.seed, r.head, r.view, r.width_mm, r.points, r.noise_mm, 100 * r.strays, 100 * r.drape, r.movement,
                r.movement_mm, r.final.target_mm, r.verdict, r.reasons);
}

}  // namespace
}  // namespace planlight::test

int main(int argc, char** argv) {
    using namespace planlight::test;
    const TrialOptions options = trial_options(argc, argv, 2000);
    const std::vector<TrialHead> heads = trial_heads(options.files);
    const auto all = run_trials(options, [&](unsigned seed) { return run(heads, seed, options.plain); });
    print_table(all);
    print_misses(all, options.plain);
}
