#include "app/evaluation/chain_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "app/evaluation/log_histogram.h"
#include "app/json_text.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

using Json = nlohmann::json;

/// A figure of the summary: where it stands in a room of report.json, and what is to be reached.
struct Figure {
    const char *name, *unit, *place;
    double goal_p95;  ///< 0: none
    std::vector<double> (*values)(const ChainFigures&);
};
constexpr double kUpdatesPerSecond = 10;  // what surgeons ask for
constexpr Figure kFigures[] = {
    {"scan points to true skin", "mm", "/scan/error_mm", 0, [](auto& r) { return r.scan_error_mm; }},
    {"registration at plan points (TRE)", "mm", "/tre_mm", 1, [](auto& r) { return r.tre_mm; }},
    {"the same, of its predicted 95 % bound", "", "/tre_of_predicted_95_bound", 1,
     [](auto& r) { return r.tre_of_bound; }},
    {"overlay on skin at rest", "mm", "/overlay_at_rest_mm", 0.4, [](auto& r) { return r.at_rest.position_mm; }},
    {"the same, measured by the cameras", "mm", "/measured_at_rest_mm", 0, [](auto& r) { return r.measured_rest_mm; }},
    {"overlay on skin, moving", "mm", "/overlay_moving_mm", 0.6, [](auto& r) { return r.moving.position_mm; }},
    {"moving, measured by the cameras", "mm", "/measured_moving_mm", 0, [](auto& r) { return r.measured_moving_mm; }},
    {"tracked pose at plan points", "mm", "/tracking_error_mm", 0, [](auto& r) { return r.tracking_error_mm; }},
    {"10 mm between ticks", "mm", "/tick_mm", 0, [](auto& r) { return r.at_rest.tick_mm; }},
    {"borehole diameter", "%", "/circle_diameter_percent", 0, [](auto& r) { return r.at_rest.diameter_percent; }},
    {"right angles", "deg", "/angle_deg", 0, [](auto& r) { return r.at_rest.angle_deg; }},
    {"product's work a tracked update", "ms", "/update_ms", 0, [](auto& r) {
         auto ms = r.update_s;
         for (double& t : ms) t *= 1000;
         return ms;
     }}};

Json to_json(const Distribution& d) {
    return {{"count", d.count}, {"median", d.median}, {"p95", d.p95}, {"worst", d.worst}};
}

/// With the bins by which it can be joined to other runs'.
Json with_bins(const std::vector<double>& values) {
    Json json = to_json(distribution_of(values));
    json["bins"] = histogram_of(values).text();
    return json;
}

ReportRow row(const Figure& figure, const Distribution& found) {
    ReportRow r{figure.name, figure.unit, found, {}, true};
    if (figure.goal_p95 > 0) {
        r.goal = fmt::format("p95 at most {:g} {}", figure.goal_p95, figure.unit);
        r.reached = found.count > 0 && found.p95 <= figure.goal_p95;
    }
    return r;
}

/// The last row is the work of an update.
void finish(PresetSummary& s) {
    const Distribution& work = s.rows.back().found;
    s.updates = static_cast<int>(work.count);
    s.updates_per_s = work.median > 0 ? 1000 / work.median : 0;
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
          {"bias_mm", room.scan_bias_mm}}},
        {"initial_match_right", room.initial_match_right},
        {"initial_error_mm", room.initial_error_mm},
        {"strokes_not_on_the_patient", room.at_rest.unseen_strokes},
        {"dark_updates", {{"at_rest", room.rest_dark}, {"moving", room.moving_dark}, {"reasons", room.dark_reasons}}},
        {"one_marker_lost", {{"updates", room.lost_marker_updates}, {"lit", room.lost_marker_lit}}},
        {"two_markers_left", {{"updates", room.too_few_updates}, {"lit", room.too_few_lit}}},
        {"seconds", room.stage_s}};
    for (const Figure& figure : kFigures) j[Json::json_pointer(figure.place)] = with_bins(figure.values(room));
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
            {"verdicts", {{"yes", s.said_yes}, {"ask", s.said_ask}}},
            {"initial_match_right", s.matched_right},
            {"figures", figures},
            {"updates_per_s", s.updates_per_s},
            {"dark_updates", s.dark_updates},
            {"updates", s.updates},
            {"one_marker_lost", {{"updates", s.lost_marker_updates}, {"lit", s.lost_marker_lit}}},
            {"two_markers_left", {{"updates", s.too_few_updates}, {"lit", s.too_few_lit}}},
            {"reached", s.missed().empty()},
            {"missed", s.missed()}};
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

std::vector<std::string> PresetSummary::missed() const {
    std::vector<std::string> goals;
    if (matched_right < rooms) goals.push_back("every patient found where it is");
    if (refused > 0) goals.push_back("no room refused");
    if (!(updates_per_s >= kUpdatesPerSecond)) goals.push_back(fmt::format("{:g} updates a second", kUpdatesPerSecond));
    if (too_few_lit > 0) goals.push_back("dark with two markers left");
    for (const ReportRow& r : rows)
        if (!r.reached) goals.push_back(r.name + ", " + r.goal);
    return goals;
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
        s.said_yes += room->registration && room->registration->verdict == Verdict::yes;
        s.said_ask += room->registration && room->registration->verdict == Verdict::ask;
        if (!room->refused.empty()) s.refusals.push_back(fmt::format("seed {}: {}", room->seed, room->refused));
        s.dark_updates += room->rest_dark + room->moving_dark;
        s.lost_marker_lit += room->lost_marker_lit;
        s.lost_marker_updates += room->lost_marker_updates;
        s.too_few_lit += room->too_few_lit;
        s.too_few_updates += room->too_few_updates;
    }
    for (const Figure& figure : kFigures) {
        std::vector<double> values_of_all;
        for (const auto* room : rooms) {
            const auto values = figure.values(*room);
            values_of_all.insert(values_of_all.end(), values.begin(), values.end());
        }
        s.rows.push_back(row(figure, distribution_of(std::move(values_of_all))));
    }
    finish(s);
    return s;
}

std::string summary_text(const PresetSummary& s) {
    const std::vector<std::string> missed = s.missed();
    std::string text =
        fmt::format("\n{} room: {} of {} patients found ({} yes, {} ask), {} refused; {:.1f} ms of work an update{}\n",
                    s.preset, s.matched_right, s.rooms, s.said_yes, s.said_ask, s.refused, s.rows.back().found.median,
                    missed.empty() ? "" : fmt::format("\n  MISSED: {}", fmt::join(missed, "; ")));
    text += fmt::format("  {:<38}{:>9}{:>9}{:>9}\n", "", "median", "95 %", "worst");
    for (const auto& r : s.rows)
        text += fmt::format("  {:<38}{:>9.3f}{:>9.3f}{:>9.3f} {:<4}{}\n", r.name, r.found.median, r.found.p95,
                            r.found.worst, r.unit,
                            r.goal.empty() ? ""
                            : r.reached    ? "  reached: " + r.goal
                                           : "  MISSED: " + r.goal);
    for (const auto& refusal : s.refusals) text += fmt::format("  refused: {}\n", refusal);
    return text;
}

std::string write_report_json(const std::filesystem::path& file, const Preparation& prepared,
                              const std::vector<ChainFigures>& rooms) {
    Json j = {{"format", "planlight report"},
              {"version", 1},
              {"program", PLANLIGHT_VERSION},
              {"preparation", preparation_json(prepared)}};
    for (const auto* preset : {"paper", "modern"})
        if (const auto s = summarise(rooms, preset); s.rooms > 0) j["presets"][preset] = summary_json(s);
    for (const auto& room : rooms) j["rooms"].push_back(room_json(room));
    const std::string text = json_text(j) + "\n";
    write_safely(file, text);
    return text;
}

namespace {

/// What the summary of a preset needs of a room in report.json.
void add_room(const Json& room, PresetSummary& s, std::vector<LogHistogram>& figures) {
    ++s.rooms;
    s.matched_right += room.at("initial_match_right").get<bool>();
    const std::string refused = room.at("refused"), seed = room.at("seed").dump();
    s.refused += !refused.empty();
    if (!refused.empty()) s.refusals.push_back("seed " + seed + ": " + refused);
    if (room.contains("registration")) {
        s.said_yes += room["registration"].at("verdict") == "yes";
        s.said_ask += room["registration"].at("verdict") == "ask";
    }
    s.dark_updates += room.at("dark_updates").at("at_rest").get<int>() + room["dark_updates"].at("moving").get<int>();
    s.lost_marker_lit += room.at("one_marker_lost").at("lit").get<int>();
    s.lost_marker_updates += room["one_marker_lost"].at("updates").get<int>();
    s.too_few_lit += room.at("two_markers_left").at("lit").get<int>();
    s.too_few_updates += room["two_markers_left"].at("updates").get<int>();
    for (std::size_t i = 0; i < std::size(kFigures); ++i)
        figures[i].add(LogHistogram::from_text(room.at(Json::json_pointer(kFigures[i].place)).at("bins")));
}

PresetSummary summary_of(const Json& rooms, const std::string& preset) {
    PresetSummary s;
    s.preset = preset;
    std::vector<LogHistogram> figures(std::size(kFigures));
    for (const Json& room : rooms)
        if (room.at("preset") == preset) add_room(room, s, figures);
    for (std::size_t i = 0; i < std::size(kFigures); ++i) s.rows.push_back(row(kFigures[i], figures[i].distribution()));
    finish(s);
    return s;
}

Json read_report(const std::filesystem::path& file) {
    try {
        Json report = Json::parse(read_whole(file));
        if (report.at("format") == "planlight report" && report.at("program").is_string() &&
            report.at("preparation").at("case").is_string() && report.at("rooms").is_array())
            return report;
    } catch (const Json::exception&) {
    }
    throw InputError(file, "is not a report.json of `planlight demo` that can be joined",
                     "Run `planlight demo` again.");
}

}  // namespace

std::vector<PresetSummary> merge_reports(const std::vector<std::filesystem::path>& reports,
                                         const std::filesystem::path& file) {
    Json joined;
    std::map<std::string, std::filesystem::path> seen;  // rooms, by preset and seed
    for (const auto& path : reports) {
        const Json report = read_report(path);
        if (joined.is_null())
            joined = {{"format", "planlight report"},
                      {"version", 1},
                      {"program", report["program"]},
                      {"preparation", report["preparation"]},
                      {"rooms", Json::array()}};
        if (report["preparation"]["case"] != joined["preparation"]["case"])
            throw InputError(path, "is of another case than " + reports.front().string(), "Join reports of one case.");
        if (report["program"] != joined["program"])
            throw InputError(path, "was made by another version of the program than " + reports.front().string(),
                             "Run it again with one version.");
        for (const Json& room : report["rooms"]) try {
                const std::string name = room.at("preset").get<std::string>() + " " + room.at("seed").dump();
                const auto [before, is_new] = seen.emplace(name, path);
                if (!is_new)
                    throw InputError(path, "holds the room " + name + ", and so does " + before->second.string(),
                                     "Give every run a range of seeds of its own.");
                joined["rooms"].push_back(room);
            } catch (const Json::exception&) {
                throw InputError(path, "holds a room without its preset and seed", "Run `planlight demo` again.");
            }
        joined["joined_from"].push_back(path.string());
    }
    std::vector<PresetSummary> summaries;
    try {
        for (const auto* preset : {"paper", "modern"})
            if (auto s = summary_of(joined["rooms"], preset); s.rooms > 0) {
                joined["presets"][preset] = summary_json(s);
                summaries.push_back(std::move(s));
            }
    } catch (const std::exception&) {  // of nlohmann, or a histogram that is none
        throw InputError(reports.front(), "or one of the others holds a room without its figures",
                         "Run `planlight demo` again.");
    }
    if (summaries.empty())
        throw InputError(reports.front(), "and the others hold no rooms", "Give reports of `planlight demo`.");
    write_safely(file, json_text(joined) + "\n");
    return summaries;
}

}  // namespace planlight
