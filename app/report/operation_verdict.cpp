// What is to be said first of an operation, and all of its figures.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "app/evaluation/distribution.h"
#include "app/json_text.h"
#include "app/recording/recording_head.h"
#include "app/report/clearance_json.h"
#include "app/report/operation_report.h"

namespace planlight {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kLook_mm = kOperationLook_mm, kStop_mm = kOperationStop_mm;

Json json_of(const Distribution& d) {
    if (d.count == 0) return {{"count", 0}, {"median", nullptr}, {"p95", nullptr}, {"worst", nullptr}};
    return {{"count", d.count}, {"median", d.median}, {"p95", d.p95}, {"worst", d.worst}};
}

Json json_of(const std::vector<OperationEvent>& events) {
    Json json = Json::array();
    for (const OperationEvent& event : events)
        json.push_back(
            {{"at_s", event.at_s}, {"utc", event.utc.empty() ? Json() : Json(event.utc)}, {"what", event.what}});
    return json;
}

/// The first six; the others are counted, and stand in the figures.
std::string names_of(const std::vector<std::string>& names) {
    constexpr std::size_t kMost = 6;
    const std::vector<std::string> first(names.begin(),
                                         names.begin() + static_cast<std::ptrdiff_t>(std::min(kMost, names.size())));
    return fmt::format("{}{}", fmt::join(first, ", "),
                       names.size() > kMost ? fmt::format(" and {} more", names.size() - kMost) : "");
}

}  // namespace

std::vector<const OperationItem*> worst_first(const std::vector<OperationItem>& items) {
    std::vector<std::pair<double, const OperationItem*>> by_rank;
    for (const OperationItem& item : items) {
        const Distribution d = distribution_of(item.measured_mm);
        const bool unseen = d.count == 0 && !item.shown.empty();
        by_rank.emplace_back(unseen ? kLook_mm : d.count > 0 ? d.p95 : 0, &item);
    }
    std::stable_sort(by_rank.begin(), by_rank.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<const OperationItem*> sorted;
    for (const auto& [rank, item] : by_rank) sorted.push_back(item);
    return sorted;
}

std::string clock_text(double s) {
    const auto whole = static_cast<long>(s);
    return fmt::format("{}:{:02}:{:02}", whole / 3600, whole % 3600 / 60, whole % 60);
}

std::string shown_text(const OperationItem& item, const OperationFacts& facts) {
    if (item.shown.empty()) return item.looked_at || facts.lit_s <= 0 ? "not shown" : "not known";
    const std::string text = clock_text(item.shown.front().first) + "–" + clock_text(item.shown.back().second);
    return item.shown.size() == 1 ? text : fmt::format("{}, {} times", text, item.shown.size());
}

bool any_risk(const OperationFacts& facts) {
    return std::any_of(facts.items.begin(), facts.items.end(),
                       [](const OperationItem& item) { return !item.risk.empty(); });
}

std::string sign_of(double value_mm) {
    return value_mm > kStop_mm ? "✗" : value_mm > kLook_mm ? "⚠" : "";
}

std::string sign_of(OperationVerdict::Kind kind) {
    using Kind = OperationVerdict::Kind;
    return kind == Kind::good ? "✓" : kind == Kind::look ? "⚠" : "✗";
}

std::string word_of(OperationVerdict::Kind kind) {
    using Kind = OperationVerdict::Kind;
    return kind == Kind::good ? "good" : kind == Kind::look ? "look" : "stop";
}

std::string duration_text(double s) {
    if (s < 60) return fmt::format("{:.1f} s", s);
    const auto whole = static_cast<long>(s + 0.5);
    return whole < 3600 ? fmt::format("{} min {:02} s", whole / 60, whole % 60)
                        : fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

OperationVerdict verdict_of(const OperationFacts& facts) {
    using Kind = OperationVerdict::Kind;
    OperationVerdict verdict;
    verdict.kind = Kind::good;
    const auto lower = [&](Kind to, const std::string& reason) {
        verdict.kind = std::max(verdict.kind, to);
        verdict.reasons.push_back(reason);
    };
    if (facts.room_kind == RoomKind::simulated) verdict.reasons.push_back("A simulated room: no patient was there.");
    if (facts.room_kind == RoomKind::recorded)
        verdict.reasons.push_back("Recorded pictures in place of cameras: no patient was there.");
    std::vector<std::string> off, unseen, not_shown, not_known;
    for (const OperationItem* item : worst_first(facts.items)) {
        const Distribution d = distribution_of(item->measured_mm);
        if (d.count > 0 && d.p95 > kLook_mm) {
            verdict.kind = std::max(verdict.kind, d.p95 > kStop_mm ? Kind::stop : Kind::look);
            off.push_back(fmt::format("{} ({:.1f} mm)", item->name, d.p95));
        }
        if (item->shown.empty())
            (item->looked_at || facts.lit_s <= 0 ? not_shown : not_known).push_back(item->name);
        else if (d.count == 0)
            unseen.push_back(item->name);
    }
    if (!off.empty())
        lower(Kind::look, fmt::format("More than {:.0f} mm off in the worst twentieth of what was measured: {}.",
                                      kLook_mm, names_of(off)));
    if (!unseen.empty()) lower(Kind::look, fmt::format("Shown, and never seen by the cameras: {}.", names_of(unseen)));
    if (!not_shown.empty()) lower(Kind::look, fmt::format("Not shown: {}.", names_of(not_shown)));
    if (!not_known.empty())
        lower(Kind::look,
              fmt::format("Whether the light reached it is not known, for no camera looked: {}.", names_of(not_known)));
    if (facts.skin_off_mm && *facts.skin_off_mm > kLook_mm)
        lower(*facts.skin_off_mm > kStop_mm ? Kind::stop : Kind::look,
              fmt::format("A check of the skin found the plan {:.1f} mm beside where the markers put it.",
                          *facts.skin_off_mm));
    if (facts.stops > 0)
        lower(Kind::look, fmt::format("The light was stopped by the system {}.",
                                      facts.stops == 1 ? "once" : fmt::format("{} times", facts.stops)));
    if (facts.verified > 0 && facts.verified == facts.verified_by_program)
        lower(Kind::look, "That the light on landmarks is right was said by the program itself: nobody looked.");
    if (facts.lit_s > 0 && facts.verified == 0) lower(Kind::look, "Nobody said that the light on landmarks is right.");
    if (std::any_of(facts.matches.begin(), facts.matches.end(),
                    [](const OperationMatch& match) { return match.verdict == "ask"; }))
        lower(Kind::look, "A match was doubtful and used on a person's word alone, if at all.");
    if (facts.lit_s > 0 && facts.aligned_s < 0.8 * facts.lit_s)
        lower(Kind::look,
              fmt::format("Only {:.0f} % of the time of light was it aligned.", 100 * facts.aligned_s / facts.lit_s));
    if (!facts.ended.empty()) lower(Kind::look, facts.ended);
    if (facts.lost_chunks > 0)
        lower(Kind::look,
              fmt::format("{} pieces are missing in the recording: the disk was too slow or full.", facts.lost_chunks));
    if (facts.updates == 0 || facts.lit_s <= 0) {
        verdict.kind = std::max(verdict.kind, Kind::look);
        verdict.sentence = facts.ended.empty() && !facts.damaged
                               ? "No light of the plan was shown."
                               : "In what is left of the recording no light of the plan was shown.";
    } else {
        const Distribution d = distribution_of(facts.light_off_mm);
        verdict.sentence = fmt::format(
            "The plan was shown for {}, aligned for {:.0f} % of it{}.", duration_text(facts.lit_s),
            100 * facts.aligned_s / facts.lit_s,
            d.count > 0 ? fmt::format("; the light lay within {:.2f} mm (median), {:.2f} mm (95 %)", d.median, d.p95)
                        : "");
    }
    return verdict;
}

PageVerdict page_verdict(const OperationFacts& facts) {
    const OperationVerdict verdict = verdict_of(facts);
    return {static_cast<PageVerdict::Kind>(verdict.kind), verdict.sentence, verdict.reasons};
}

Deviations deviations_of(const OperationFacts& facts) {
    Deviations of;
    double sum = 0, squares = 0;
    for (const OperationItem& item : facts.items)
        for (const double mm : item.measured_mm) {
            ++of.count;
            sum += mm, squares += mm * mm;
            of.worst_mm = std::max(of.worst_mm, mm);
        }
    if (of.count == 0) return of;
    const auto n = static_cast<double>(of.count);
    of.mean_mm = sum / n;
    of.rms_mm = std::sqrt(squares / n);
    if (of.count > 1) of.deviation_mm = std::sqrt(std::max(0.0, squares - n * of.mean_mm * of.mean_mm) / (n - 1));
    return of;
}

std::string in_terms_of_f2554(const OperationFacts& facts) {
    const Deviations of = deviations_of(facts);
    if (of.count == 0) return {};
    return fmt::format(
        "In the terms of ASTM F2554: positional deviation of {} measurements, mean {:.2f} mm, standard deviation "
        "{:.2f} mm, RMS {:.2f} mm, maximum {:.2f} mm. These are distances: no bias by direction; and no test by that "
        "practice, with its pointer and its reference points.",
        of.count, of.mean_mm, of.deviation_mm, of.rms_mm, of.worst_mm);
}

std::string named(const OperationItem& item) {
    return item.code.empty() ? item.name : item.code + "  " + item.name;
}

std::string operator_text(const RecordingHead& head) {
    const bool account = !head.operator_named && !head.operator_name.empty();
    return head.operator_name + (account ? " (account of the computer)" : "");
}

std::string settings_in_words(const RecordingHead& head) {
    const Json settings = Json::parse(head.settings, nullptr, false);
    if (!settings.is_object()) return {};
    try {
        const Json& gate = settings.at("gate");
        std::string words = fmt::format("gate: amber above {:g} mm, dark above {:g} mm",
                                        gate.at("warn_mm").get<double>(), gate.at("stop_mm").get<double>());
        if (settings.contains("light_delay_ms"))
            words += fmt::format("; projector latency {:g} ms ({})", settings.at("light_delay_ms").get<double>(),
                                 settings.at("light_delay_from").get<std::string>());
        return words;
    } catch (const Json::exception&) {
        return {};  // another program's: they stand in the figures as they are
    }
}

std::string operation_json(const OperationFacts& facts) {
    const OperationVerdict verdict = verdict_of(facts);
    const RecordingHead& head = facts.head;
    Json json = {{"format", "planlight operation"},
                 {"version", 1},
                 {"verdict", word_of(verdict.kind)},
                 {"sentence", verdict.sentence},
                 {"reasons", verdict.reasons},
                 {"case", head.case_code},
                 {"title", head.case_title},
                 {"plan", head.plan_name},
                 {"plan_version", head.plan_version},
                 {"room", facts.room},
                 {"simulated", facts.room_kind == RoomKind::simulated},
                 {"recorded", facts.room_kind == RoomKind::recorded},
                 {"began", head.began_utc},
                 {"room_entered", facts.room_entered_utc},
                 {"operator", head.operator_name},
                 {"operator_named", head.operator_named},
                 {"computer", head.computer},
                 {"program", head.program},
                 {"settings", head.settings.empty() ? Json() : Json::parse(head.settings)},
                 {"rig_made_on", facts.rig_made_on},
                 {"serials", facts.serials},
                 {"hashes",
                  {{"recording", facts.recording_hash},
                   {"volume", head.volume_hash},
                   {"skin", head.mesh_hash},
                   {"plan", head.plan_hash},
                   {"rig", facts.rig_hash},
                   {"program", head.program_hash}}},
                 {"lasted_s", facts.lasted_s},
                 {"lit_s", facts.lit_s},
                 {"aligned_s", facts.aligned_s},
                 {"look_s", facts.look_s},
                 {"updates", facts.updates},
                 {"verified", facts.verified},
                 {"verified_by_program", facts.verified_by_program},
                 {"stops", facts.stops},
                 {"skin_off_mm", facts.skin_off_mm ? Json(*facts.skin_off_mm) : Json()},
                 {"light_off_mm", json_of(distribution_of(facts.light_off_mm))}};
    if (const Deviations of = deviations_of(facts); of.count > 0)
        json["f2554"] = {{"count", of.count},
                         {"mean_mm", of.mean_mm},
                         {"standard_deviation_mm", of.deviation_mm},
                         {"rms_mm", of.rms_mm},
                         {"maximum_mm", of.worst_mm}};
    json["items"] = Json::array();
    for (const OperationItem& item : facts.items) {
        Json shown = Json::array();
        for (const auto& [from, to] : item.shown) shown.push_back({from, to});
        json["items"].push_back({{"name", item.name},
                                 {"shown_s", item.shown_s},
                                 {"shown", item.looked_at || facts.lit_s <= 0 ? shown : Json()},
                                 {"predicted_mm", item.predicted_mm ? Json(*item.predicted_mm) : Json()},
                                 {"risk", clearances_json(item.risk)},
                                 {"measured_mm", json_of(distribution_of(item.measured_mm))}});
    }
    json["matches"] = Json::array();
    for (const OperationMatch& match : facts.matches)
        json["matches"].push_back({{"at_s", match.at_s},
                                   {"utc", match.utc},
                                   {"verdict", match.verdict},
                                   {"reasons", match.reasons},
                                   {"residual_rms_mm", match.residual_rms_mm ? Json(*match.residual_rms_mm) : Json()},
                                   {"points", match.points}});
    json["dark"] = Json::array();
    for (const auto& [reason, how] : facts.dark)
        json["dark"].push_back({{"reason", reason}, {"times", how.first}, {"seconds", how.second}});
    json["said"] = json_of(facts.said);
    json["refusals"] = json_of(facts.refusals);
    json["recording"] = {{"file", facts.file},   {"record", word_of(head.mode)}, {"chunks", facts.chunks},
                         {"bytes", facts.bytes}, {"frames", facts.kept_frames},  {"lost_chunks", facts.lost_chunks},
                         {"ended", facts.ended}};
    return json_text(json) + "\n";
}

}  // namespace planlight
