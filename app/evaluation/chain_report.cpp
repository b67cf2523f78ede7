#include "app/evaluation/chain_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "planning_io/files/safe_write.h"

namespace planlight {
namespace {

using Json = nlohmann::json;

Json to_json(const Distribution& d) {
    return {{"count", d.count}, {"median", d.median}, {"p95", d.p95}, {"worst", d.worst}};
}

template <class Get>
std::vector<double> gather(const std::vector<const ChainFigures*>& rooms, Get get) {
    std::vector<double> all;
    for (const auto* room : rooms) {
        const auto& values = get(*room);
        all.insert(all.end(), values.begin(), values.end());
    }
    return all;
}

ReportRow row(const std::string& name, const std::string& unit, const std::vector<double>& values,
              double goal_p95 = 0) {
    ReportRow r{name, unit, distribution_of(values), {}, true};
    if (goal_p95 > 0) {
        r.goal = fmt::format("p95 at most {:g} {}", goal_p95, unit);
        r.reached = r.found.count > 0 && r.found.p95 <= goal_p95;
    }
    return r;
}

const char* word_for(Verdict verdict) {
    return verdict == Verdict::yes ? "yes" : verdict == Verdict::ask ? "ask" : "no";
}

Json room_json(const ChainFigures& room) {
    Json j = {
        {"preset", room.preset},
        {"seed", room.seed},
        {"refused", room.refused},
        {"scan",
         {{"patterns", room.patterns},
          {"light_s", room.scan_simulated_s},
          {"points", room.scan_points},
          {"decoded_left", room.decoded_left},
          {"decoded_right", room.decoded_right},
          {"removed", room.removed},
          {"bias_mm", room.scan_bias_mm},
          {"error_mm", to_json(distribution_of(room.scan_error_mm))}}},
        {"initial_match_right", room.initial_match_right},
        {"initial_error_mm", room.initial_error_mm},
        {"tre_mm", to_json(distribution_of(room.tre_mm))},
        {"tre_of_predicted_95_bound", to_json(distribution_of(room.tre_of_bound))},
        {"tracking_error_mm", to_json(distribution_of(room.tracking_error_mm))},
        {"overlay_at_rest_mm", to_json(distribution_of(room.at_rest.position_mm))},
        {"overlay_moving_mm", to_json(distribution_of(room.moving.position_mm))},
        {"circle_diameter_percent", to_json(distribution_of(room.at_rest.diameter_percent))},
        {"tick_mm", to_json(distribution_of(room.at_rest.tick_mm))},
        {"angle_deg", to_json(distribution_of(room.at_rest.angle_deg))},
        {"strokes_not_on_the_patient", room.at_rest.unseen_strokes},
        {"dark_updates", {{"at_rest", room.rest_dark}, {"moving", room.moving_dark}, {"reasons", room.dark_reasons}}},
        {"one_marker_lost", {{"updates", room.lost_marker_updates}, {"lit", room.lost_marker_lit}}},
        {"two_markers_left", {{"updates", room.too_few_updates}, {"lit", room.too_few_lit}}},
        {"seconds", room.stage_s},
        {"update_s", to_json(distribution_of(room.update_s))}};
    if (room.registration)
        j["registration"] = {{"verdict", word_for(room.registration->verdict)},
                             {"reasons", room.registration->reasons},
                             {"residual_rms_mm", room.registration->residual_rms_mm},
                             {"inlier_fraction", room.registration->inlier_fraction},
                             {"runner_up_ratio", room.registration->runner_up_ratio},
                             {"agreeing_bases", room.registration->agreeing_bases}};
    return j;
}

Json summary_json(const PresetSummary& s) {
    Json figures = Json::object();
    for (const auto& r : s.rows) {
        figures[r.name] = to_json(r.found);
        figures[r.name]["unit"] = r.unit;
        if (!r.goal.empty()) {
            figures[r.name]["goal"] = r.goal;
            figures[r.name]["reached"] = r.reached;
        }
    }
    return {{"rooms", s.rooms},
            {"refused", s.refused},
            {"refusals", s.refusals},
            {"initial_match_right", s.matched_right},
            {"figures", figures},
            {"updates_per_s", s.updates_per_s},
            {"dark_updates", s.dark_updates},
            {"updates", s.updates},
            {"one_marker_lost", {{"updates", s.lost_marker_updates}, {"lit", s.lost_marker_lit}}},
            {"two_markers_left", {{"updates", s.too_few_updates}, {"lit", s.too_few_lit}}},
            {"reached", s.reached()}};
}

Json preparation_json(const Preparation& prepared) {
    const Case& c = prepared.prepared;
    return {{"case", c.code},
            {"threshold", prepared.threshold},
            {"body_ml", prepared.body_ml},
            {"removed_ml", prepared.removed_ml},
            {"removed_pieces", prepared.pieces_removed},
            {"triangles", c.skin.triangles.size()},
            {"lut_size", c.lut.size},
            {"lut_voxel_mm", c.lut.voxel_mm},
            {"skin_voxels", c.lut.skin.size()},
            {"warnings", c.warnings},
            {"seconds", {{"skin", prepared.segment_s}, {"surface", prepared.triangulate_s}, {"lut", prepared.lut_s}}}};
}

}  // namespace

bool PresetSummary::reached() const {
    return matched_right == rooms && refused == 0 && updates_per_s >= 10 && too_few_lit == 0 &&
           std::all_of(rows.begin(), rows.end(), [](const auto& r) { return r.reached; });
}

PresetSummary summarise(const std::vector<ChainFigures>& all, const std::string& preset) {
    std::vector<const ChainFigures*> rooms;
    for (const auto& room : all)
        if (room.preset == preset) rooms.push_back(&room);
    PresetSummary s;
    s.preset = preset;
    s.rooms = rooms.size();
    for (const auto* room : rooms) {
        s.matched_right += room->initial_match_right;
        s.refused += !room->refused.empty();
        if (!room->refused.empty()) s.refusals.push_back(fmt::format("seed {}: {}", room->seed, room->refused));
        s.dark_updates += room->rest_dark + room->moving_dark;
        s.lost_marker_lit += room->lost_marker_lit;
        s.lost_marker_updates += room->lost_marker_updates;
        s.too_few_lit += room->too_few_lit;
        s.too_few_updates += room->too_few_updates;
    }
    s.rows = {
        row("scan points to true skin", "mm", gather(rooms, [](auto& r) { return r.scan_error_mm; })),
        row("registration at plan points (TRE)", "mm", gather(rooms, [](auto& r) { return r.tre_mm; }), 1),
        row("the same, of its predicted 95 % bound", "", gather(rooms, [](auto& r) { return r.tre_of_bound; }), 1),
        row("overlay on skin at rest", "mm", gather(rooms, [](auto& r) { return r.at_rest.position_mm; }), 1),
        row("overlay on skin, moving", "mm", gather(rooms, [](auto& r) { return r.moving.position_mm; }), 2),
        row("tracked pose at plan points", "mm", gather(rooms, [](auto& r) { return r.tracking_error_mm; })),
        row("10 mm between ticks", "mm", gather(rooms, [](auto& r) { return r.at_rest.tick_mm; })),
        row("borehole diameter", "%", gather(rooms, [](auto& r) { return r.at_rest.diameter_percent; })),
        row("right angles", "deg", gather(rooms, [](auto& r) { return r.at_rest.angle_deg; }))};
    auto update_s = gather(rooms, [](auto& r) { return r.update_s; });
    s.updates = static_cast<int>(update_s.size());
    for (double& t : update_s) t *= 1000;
    s.rows.push_back(row("product's work a tracked update", "ms", update_s));
    s.updates_per_s = s.rows.back().found.median > 0 ? 1000 / s.rows.back().found.median : 0;
    return s;
}

std::string write_report_json(const std::filesystem::path& file, const Preparation& prepared,
                              const std::vector<ChainFigures>& rooms) {
    Json j = {{"format", "planlight report"}, {"version", 1}, {"preparation", preparation_json(prepared)}};
    for (const auto* preset : {"paper", "modern"})
        if (const auto s = summarise(rooms, preset); s.rooms > 0) j["presets"][preset] = summary_json(s);
    for (const auto& room : rooms) j["rooms"].push_back(room_json(room));
    const std::string text = j.dump(2) + "\n";
    write_safely(file, text);
    return text;
}

}  // namespace planlight
