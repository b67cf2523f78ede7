// What a scan is worth in random simulated rooms: measure_scan_rooms [SEED] [COUNT] [paper|modern|both] [--volume FILE]
// [--spoilt N] [--set full|fast|multi-frequency|multi-frequency-columns] [--json FILE] [--pictures FOLDER]
// [--perfect] (a calibration without error).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iostream>
#include <nlohmann/json.hpp>

#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "planning_io/types/statistics.h"
#include "planning_io/volume/read_volume.h"
#include "registration/calibration/check_drift.h"
#include "tests/registration/scan/footprint_figures.h"
#include "tests/registration/scan/random_rooms.h"
#include "tests/registration/scan/scan_figures.h"
#include "tests/registration/scan/scan_pictures.h"
#include "tests/registration/scan/spoilt_rigs.h"

using namespace planlight;
using namespace planlight::scan_rooms;
using simulation::Preset;
using simulation::SimulatedRig;
using Json = nlohmann::ordered_json;

namespace {

struct Options {
    unsigned seed = 1, count = 3, spoilt = 1;
    bool perfect = false;
    std::vector<Preset> presets{Preset::paper, Preset::modern};
    std::string volume = "/usr/share/doc/invesalius-examples/examples/Cranium.inv3", json, pictures, set = "full";
};

Options parse(int argc, char** argv) {
    Options o;
    int place = 0;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const auto next = [&] { return std::string(i + 1 < argc ? argv[++i] : ""); };
        if (word == "--volume")
            o.volume = next();
        else if (word == "--json")
            o.json = next();
        else if (word == "--pictures")
            o.pictures = next();
        else if (word == "--set")
            o.set = next();
        else if (word == "--spoilt")
            o.spoilt = static_cast<unsigned>(std::stoul(next()));
        else if (word == "--perfect")
            o.perfect = true;
        else if (word == "paper")
            o.presets = {Preset::paper};
        else if (word == "modern")
            o.presets = {Preset::modern};
        else if (word == "both")
            o.presets = {Preset::paper, Preset::modern};
        else
            (place++ == 0 ? o.seed : o.count) = static_cast<unsigned>(std::stoul(word));
    }
    return o;
}

/// One number a room, under the name it has in the table.
using Figures = std::vector<std::pair<std::string, double>>;

Figures figures_of_head(const ScanResult& scan, const SimulatedRig& room, Instant at) {
    const RigCalibration true_rig = room.true_rig();
    const CloudFigures cloud = cloud_figures(scan, room, room.calibration(), at);
    CodeFigures code = code_figures(scan.left, room, SimulatedRig::Camera::left, true_rig, at);
    const CodeFigures right = code_figures(scan.right, room, SimulatedRig::Camera::right, true_rig, at);
    code.looked_at += right.looked_at;
    code.wrong += right.wrong;
    code.wrong_inside += right.wrong_inside;
    code.wrong_facing += right.wrong_facing;
    const DriftCheck check = check_drift(scan, room.calibration());
    const double decoded = std::max<double>(1, static_cast<double>(code.looked_at));
    return {{"noise, rms, facing (mm)", cloud.noise_mm},
            {"noise, rms, all (mm)", cloud.noise_all_mm},
            {"noise, usual (mm)", cloud.noise_usual_mm},
            {"bias, size (mm)", std::abs(cloud.bias_mm)},
            {"bent, rms (mm)", cloud.slow_mm},
            {"missing skin (%)", 100 * (1 - cloud.completeness)},
            {"wrong codes, facing", static_cast<double>(code.wrong_facing) / decoded},
            {"wrong codes, grazing too", static_cast<double>(code.wrong_inside) / decoded},
            {"wrong codes, silhouettes too", static_cast<double>(code.wrong) / decoded},
            {"chi-square, mean", cloud.chi_square},
            {"chi-square by median", cloud.chi_square_median},
            {"epipolar, usual (px)", check.epipolar_px},
            {"epipolar rms, wrong partners too", scan.raw.epipolar_rms_px},
            {"check: k1 off, size", std::abs(check.bent.k1_off)},
            {"check: k1 off by its sigma", std::abs(check.bent.k1_off) / std::max(1e-9, check.bent.k1_sigma)},
            {"check: light bent (px)", check.bent.projector_px},
            {"check: not called good", check.verdict == DriftCheck::Verdict::good ? 0.0 : 1.0},
            {"projector off (px)", scan.raw.projector_offset_px.norm()},
            {"points", static_cast<double>(cloud.points)},
            {"signed bias (mm)", cloud.bias_mm}};
}

/// Where the noise on the head comes from: a second scan of the same room, other noise.
Figures figures_of_footprint(const ScanResult& scan, SimulatedRig& room, const std::string& set, Instant at) {
    const ScanResult again = scan_from_capture(capture_of(room, set), room.calibration());
    const FootprintFigures f = footprint_figures(scan, again, room, room.calibration(), at);
    return {{"off the skin at the pixel (mm)", f.at_point_mm},
            {"off it, blurred by the lens (mm)", f.by_lens_mm},
            {"off it, fitted over 5 x 5 px (mm)", f.by_window_mm},
            {"two scans / sqrt 2 (mm)", f.repeat_mm},
            {"points of both scans", static_cast<double>(f.repeated)}};
}

/// The same room with a smooth ball of skin instead of the head: there is no detail in it that a scan could miss.
Figures figures_of_ball(const Volume& sphere, simulation::RoomSettings settings, const std::string& set) {
    settings.markers = 0;
    SimulatedRig room(sphere, {}, settings);
    const ScanCapture capture = capture_of(room, set);
    const ScanResult scan = scan_from_capture(capture, room.calibration());
    const CloudFigures cloud = cloud_figures(scan, room, room.calibration(), capture.began);
    const double radius = fitted_radius_mm(scan.clean.kept.points_in_rig);
    return {{"ball: noise, rms, facing (mm)", cloud.noise_mm},
            {"ball: noise, rms, all (mm)", cloud.noise_all_mm},
            {"ball: bias, size (mm)", std::abs(cloud.bias_mm)},
            {"ball: radius, error (mm)", std::abs(radius - kSphereRadius_mm)},
            {"ball: radius, signed (mm)", radius - kSphereRadius_mm},
            {"ball: chi-square, mean", cloud.chi_square},
            {"ball: chi-square by median", cloud.chi_square_median}};
}

struct Spoilt {
    std::string what;
    unsigned rooms = 0, noticed = 0, placed = 0;  ///< `placed`: the projector could be placed by the points
    double epipolar_px = 0, projector_px = 0, after_px = 0, offset_px = 0, error_mm = 0;  // sums
    std::map<std::string, int> verdicts;
};

void try_spoilt(const ScanCapture& capture, const SimulatedRig& room, std::vector<Spoilt>& table) {
    const auto spoilt = spoilt_rigs();
    table.resize(spoilt.size());
    for (std::size_t i = 0; i < spoilt.size(); ++i) {
        Spoilt& row = table[i];
        row.what = spoilt[i].what;
        RigCalibration rig = room.calibration();
        spoilt[i].spoil(rig);
        const ScanResult scan = scan_from_capture(capture, rig);
        const DriftCheck check = check_drift(scan, rig);
        ++row.rooms;
        row.noticed += check.verdict != DriftCheck::Verdict::good;
        ++row.verdicts[text_of(check.verdict)];
        row.epipolar_px += check.epipolar_px;
        row.placed += check.projector_rms_px > 0;
        row.projector_px += check.projector_rms_px;
        row.after_px += check.projector_after_px;
        row.offset_px += scan.raw.projector_offset_px.norm();
        std::vector<double> errors = room.scan_errors_mm(scan.clean.kept.points_in_rig, capture.began);
        for (double& e : errors) e = std::abs(e);
        if (errors.empty()) continue;
        row.error_mm += median(errors);
    }
}

struct PresetTable {
    std::vector<Figures> rooms;
    std::vector<std::string> refusals;
    std::vector<Spoilt> spoilt;
};

PresetTable run(Preset preset, const Options& options, const Volume& head, const Volume& sphere) {
    PresetTable table;
    for (unsigned k = 0; k < options.count; ++k) {
        const unsigned seed = options.seed + k;
        try {
            simulation::RoomSettings settings = random_room(preset, seed);
            if (options.perfect) settings.calibration_error = 0;
            SimulatedRig room(head, {}, settings);
            const ScanCapture capture = capture_of(room, options.set);
            const ScanResult scan = scan_from_capture(capture, room.calibration());
            if (scan.clean.kept.empty()) throw CheckFailedError("no skin was found", "-");
            Figures figures = figures_of_head(scan, room, capture.began);
            for (auto& figure : figures_of_ball(sphere, settings, options.set)) figures.push_back(std::move(figure));
            for (auto& figure : figures_of_footprint(scan, room, options.set, capture.began))
                figures.push_back(std::move(figure));
            table.rooms.push_back(std::move(figures));
            if (k == 0 && !options.pictures.empty() && preset == options.presets.back())
                write_scan_pictures(room, capture, scan, options.pictures);
            if (k < options.spoilt) try_spoilt(capture, room, table.spoilt);
        } catch (const Error& refusal) {
            table.refusals.push_back(fmt::format("seed {}: {}", seed, refusal.what()));
        }
        fmt::print(stderr, "\r{} {} of {} ", name_of(preset), k + 1, options.count);
    }
    fmt::print(stderr, "\n");
    return table;
}

/// Median, 95th percentile and worst by rank.
std::array<double, 3> distribution(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const auto at = [&](double share) {
        const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
        return values[std::max<std::size_t>(rank, 1) - 1];
    };
    return {at(0.5), at(0.95), values.back()};
}

std::string number(double v) {
    if (v != 0 && std::abs(v) < 1e-3) return fmt::format("{:.1e}", v);
    return std::abs(v) >= 100 ? fmt::format("{:.0f}", v) : fmt::format("{:.3f}", v);
}

Json print_table(const std::string& name, const PresetTable& table) {
    Json json = {{"rooms", table.rooms.size()}, {"refusals", table.refusals}};
    fmt::print("\n{}: {} rooms, {} refused\n", name, table.rooms.size() + table.refusals.size(), table.refusals.size());
    for (const std::string& refusal : table.refusals) fmt::print("  {}\n", refusal);
    if (table.rooms.empty()) return json;
    fmt::print("{:32}{:>12}{:>12}{:>12}\n", "", "median", "95 %", "worst");
    for (std::size_t i = 0; i < table.rooms.front().size(); ++i) {
        std::vector<double> values;
        for (const Figures& room : table.rooms) values.push_back(room[i].second);
        const auto [half, most, worst] = distribution(values);
        fmt::print("{:32}{:>12}{:>12}{:>12}\n", table.rooms.front()[i].first, number(half), number(most),
                   number(worst));
        json["figures"][table.rooms.front()[i].first] = {
            {"median", half}, {"p95", most}, {"worst", worst}, {"rooms", values}};
    }
    return json;
}

Json print_spoilt(const std::vector<Spoilt>& table) {
    Json json = Json::array();
    if (table.empty()) return json;
    fmt::print("\n{:42}{:>9}{:>10}{:>11}{:>8}{:>9}{:>10}  said\n", "wrong on purpose", "noticed", "epipolar",
               "projector", "after", "offset", "error mm");
    for (const Spoilt& row : table) {
        const double n = row.rooms, placed = std::max(1u, row.placed);
        std::string said;
        for (const auto& [verdict, count] : row.verdicts)
            said += fmt::format("{}{} {}", said.empty() ? "" : ", ", count, verdict);
        fmt::print("{:42}{:>3} of {:>2}{:>10.3f}{:>11.3f}{:>8.3f}{:>9.3f}{:>10.3f}  {}\n", row.what, row.noticed,
                   row.rooms, row.epipolar_px / n, row.projector_px / placed, row.after_px / placed, row.offset_px / n,
                   row.error_mm / n, said);
        json.push_back({{"what", row.what},
                        {"rooms", row.rooms},
                        {"noticed", row.noticed},
                        {"epipolar_px", row.epipolar_px / n},
                        {"projector_placed", row.placed},
                        {"projector_px", row.projector_px / placed},
                        {"after_px", row.after_px / placed},
                        {"offset_px", row.offset_px / n},
                        {"median_error_mm", row.error_mm / n},
                        {"said", said}});
    }
    return json;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const Options options = parse(argc, argv);
        const Volume head = read_volume(options.volume), sphere = sphere_volume();
        Json json = {{"seed", options.seed}, {"count", options.count}};
        for (const Preset preset : options.presets) {
            const PresetTable table = run(preset, options, head, sphere);
            json[name_of(preset)] = print_table(name_of(preset), table);
            json[name_of(preset)]["wrong_on_purpose"] = print_spoilt(table.spoilt);
        }
        if (!options.json.empty()) write_safely(options.json, json.dump(2) + "\n");
        return 0;
    } catch (const Error& error) {
        fmt::print(stderr, "{} {}\n", error.what(), error.remedy);
        return static_cast<int>(error.exit_code);
    } catch (const std::exception& error) {
        fmt::print(stderr, "measure_scan_rooms: {}\n", error.what());
        return static_cast<int>(ExitCode::usage);
    }
}
