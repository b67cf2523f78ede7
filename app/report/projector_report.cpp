#include "app/report/projector_report.h"
#include "app/json_text.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace planlight {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const ResponseResult& r) {
    Json curve = Json::array();
    for (const ResponsePoint& p : r.curve)
        curve.push_back({{"grey", p.grey}, {"light", p.light}, {"sigma", p.sigma}, {"frames", p.frames}});
    Json json = {{"gamma", r.gamma},
                 {"gamma_sigma", r.gamma_sigma},
                 {"dark_end_grey", r.dark_end},
                 {"dark_end_sigma_grey", r.dark_end_sigma},
                 {"bright_end_grey", r.bright_end},
                 {"bright_end_sigma_grey", r.bright_end_sigma},
                 {"crushes_darks", r.crushes_darks},
                 {"crushes_whites", r.crushes_whites},
                 {"worst_departure", r.worst_departure},
                 {"rising", r.not_rising.empty()},
                 {"not_rising_greys", r.not_rising},
                 {"black_level", r.black_level},
                 {"black_level_sigma", r.black_level_sigma},
                 {"black_level_is_a_bound", r.black_level_is_a_bound},
                 {"white_drift", r.white_drift},
                 {"cameras_differ", r.cameras_differ},
                 {"black_grey", r.black_grey},
                 {"white_grey", r.white_grey},
                 {"tiles", r.tiles},
                 {"saturated_tiles", r.saturated_tiles},
                 {"tiles_at_zero", r.tiles_at_zero}};
    if (r.colours)
        json["colours"] = {{"red", (*r.colours)[0]},
                           {"green", (*r.colours)[1]},
                           {"blue", (*r.colours)[2]},
                           {"sigmas", r.colour_sigmas}};
    json["curve"] = std::move(curve);
    json["meaning"] = meaning_of(r);
    return json;
}

Json json_of(const CycleResult& r) {
    Json runs = Json::array();
    for (const CycleRun& run : r.runs)
        runs.push_back({{"picture", run.name},
                        {"frames", run.frames},
                        {"light_grey", run.light_grey},
                        {"variation", run.variation},
                        {"variation_sigma", run.variation_sigma},
                        {"at_most", run.at_most},
                        {"varies", run.varies},
                        {"size_is_told", run.size_is_told},
                        {"seen_hz", run.seen_hz ? Json(*run.seen_hz) : Json(nullptr)},
                        {"cycles_hz", run.cycles_hz},
                        {"trace", run.trace}});
    return {{"projector_varies", r.projector_varies},
            {"room_varies", r.room_varies},
            {"worst_variation", r.worst},
            {"worst_is_told", r.worst_is_told},
            {"frames_hz", r.frames_hz},
            {"exposure_ms", 1e3 * r.exposure_s},
            {"exposure_to_set_ms", r.exposure_to_set_s > 0 ? Json(1e3 * r.exposure_to_set_s) : Json(nullptr)},
            {"cycle_is_told", r.cycle_is_told},
            {"cannot_be_seen_hz", r.unseen_hz},
            {"frames_lost", r.timing.lost},
            {"meaning", meaning_of(r)},
            {"runs", std::move(runs)}};
}

Json json_of(const LatencyResult& r) {
    Json delays = Json::array();
    for (const LightDelay& d : r.delays) delays.push_back({1e3 * d.at_least_s, 1e3 * d.at_most_s});
    Json json = {{"median_ms", 1e3 * r.median_s},
                 {"median_sigma_ms", 1e3 * r.median_sigma_s},
                 {"jitter_ms", 1e3 * r.jitter_s},
                 {"jitter_sigma_ms", 1e3 * r.jitter_sigma_s},
                 {"latest_ms", 1e3 * r.latest_s},
                 {"light_delay_ms", 1e3 * r.light_delay_s},
                 {"changes", r.changes},
                 {"seen", r.delays.size()},
                 {"seen_within_an_exposure", r.exact},
                 {"never_light", r.unseen},
                 {"late", r.late},
                 {"frames_lost", r.frames.lost},
                 {"frames_doubled", r.frames.doubled},
                 {"code_agreement", r.code_agreement},
                 {"runner_up_agreement", r.runner_up_agreement}};
    if (r.promise)
        json["promised"] = {{"delay_ms", 1e3 * r.promise->delay_s},
                            {"pictures", r.promise->orders},
                            {"broken", r.promise->broken},
                            {"too_early_ms", 1e3 * r.promise->too_early_s}};
    json["at_least_at_most_ms"] = std::move(delays);
    json["meaning"] = meaning_of(r);
    return json;
}

template <class Result>
void add(Json& json, const char* key, const std::optional<Result>& result) {
    if (result && !result->refusal) json[key] = json_of(*result);
}

template <class Result>
void add_findings_of(const std::optional<Result>& result, std::vector<LightFinding>& findings) {
    if (!result || result->refusal) return;
    for (LightFinding& finding : findings_of(*result)) findings.push_back(std::move(finding));
}

}  // namespace

std::vector<LightFinding> findings_of(const ProjectorReport& report) {
    std::vector<LightFinding> findings;
    add_findings_of(report.response, findings);
    add_findings_of(report.cycle, findings);
    add_findings_of(report.latency, findings);
    return findings;
}

std::string projector_summary(const ProjectorReport& report) {
    std::string text =
        report.source + (report.width > 0 ? fmt::format(", {} x {}", report.width, report.height) : std::string());
    if (!report.monitor.empty()) text += ", monitor " + report.monitor;
    if (!report.serial.empty()) text += ", serial " + report.serial;
    text += "\n";
    if (report.response && !report.response->refusal) {
        const ResponseResult& r = *report.response;
        text += fmt::format(
            "  response     gamma {:.2f} ± {:.2f}, black up to {:.0f}, white from {:.0f}, black {}{:.4f} of white\n",
            r.gamma, r.gamma_sigma, r.dark_end, r.bright_end, r.black_level_is_a_bound ? "with the room's light " : "",
            r.black_level);
        if (r.colours)
            text += fmt::format("  colours      red {:.2f}, green {:.2f}, blue {:.2f} of white\n", (*r.colours)[0],
                                (*r.colours)[1], (*r.colours)[2]);
    }
    if (report.cycle && !report.cycle->refusal) text += "  colour cycle " + meaning_of(*report.cycle) + "\n";
    if (report.latency && !report.latency->refusal) text += "  latency      " + meaning_of(*report.latency) + "\n";
    return text;
}

std::string projector_json(const ProjectorReport& report) {
    Json json = {
        {"format", "planlight projector"}, {"version", 1}, {"made_on", report.made_on}, {"source", report.source}};
    Json projector = Json::object();
    if (report.width > 0) projector["width"] = report.width, projector["height"] = report.height;
    if (!report.monitor.empty()) projector["monitor"] = report.monitor;
    if (!report.serial.empty()) projector["serial"] = report.serial;
    json["projector"] = std::move(projector);
    json["findings"] = Json::array();
    for (const LightFinding& finding : findings_of(report))
        json["findings"].push_back({{"what", finding.what}, {"remedy", finding.remedy}});
    add(json, "latency", report.latency);
    add(json, "response", report.response);
    add(json, "cycle", report.cycle);
    return json_text(json) + "\n";
}

}  // namespace planlight
