#include "app/recording/session_events.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "app/case_model.h"
#include "app/console.h"
#include "app/report/clearance_json.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/files/content_hash.h"

namespace planlight::session_events {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kCalls{"scan",    "find_patient", "confirm", "update",    "check_skin", "light_landmark",
                            "go_dark", "light_item",   "resume",  "hide_item", "show_item"};
constexpr std::array kGateCalls{"step", "verify", "skin_checked", "new_match", "restart", "other_light", "forbids"};
constexpr std::array kVerdicts{"yes", "ask", "no"};
constexpr std::array kTrusts{"dark", "look", "aligned"};
constexpr std::array kFaults{"late_picture",   "projector_moved", "left_camera_moved", "right_camera_moved",
                             "marker_slipped", "markers_moved",   "no_picture",        "other_picture",
                             "partly_covered", "light_off"};

template <class Words, class Enum>
bool find_word(const Words& words, const std::string& word, Enum& value) {
    for (std::size_t i = 0; i < words.size(); ++i)
        if (word == words[i]) {
            value = static_cast<Enum>(i);
            return true;
        }
    return false;
}

Json json_of(const Eigen::Vector3d& v) {
    return {v.x(), v.y(), v.z()};
}

Json json_of(const RigidTransform& t) {
    Json rows = Json::array();
    for (Eigen::Index i = 0; i < 16; ++i) rows.push_back(t.matrix()(i / 4, i % 4));
    return rows;
}

/// Text of a fault may hold what is no UTF-8 (a file's name): that must not end a recording.
std::string text_of(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string hash_of(const PointCloud& cloud) {
    ContentHash hash;
    for (const Eigen::Vector3d& p : cloud.points_in_rig) hash.add_values(p.data(), 3);
    return hash.hex();
}

Json json_of(const LightCheck& check) {
    Json items = Json::array();
    for (const ItemLight& item : check.items)
        items.push_back({item.lit, item.segments, item.seen, item.off_mm, item.sigma_mm});
    Json json{{"items", items},
              {"expected", check.expected},
              {"seen", check.seen},
              {"off_mm", check.off_mm},
              {"median_mm", check.median_mm},
              {"most_mm", check.most_mm},
              {"sigma_mm", check.sigma_mm},
              {"background", check.background},
              {"brighter", check.brighter},
              {"fainter", check.fainter},
              {"told_whole", check.told_whole}};
    if (check.far_mm) json["far_mm"] = *check.far_mm;
    return json;
}

Json json_of(const LightCause& cause) {
    return {{"fault", word_of(cause.fault)},
            {"size", cause.size},
            {"low", cause.low},
            {"high", cause.high},
            {"marker", cause.marker},
            {"share", cause.share},
            {"light_is_wrong", cause.light_is_wrong}};
}

Json json_of(const TrackedPose& pose) {
    Json json = {{"rig_from_patient", nullptr},     {"markers", {pose.markers_left, pose.markers_right}},
                 {"residual_px", pose.residual_px}, {"predicted_error_mm", pose.predicted_error_mm},
                 {"bound_95_mm", pose.bound_95_mm}, {"external_reliability_mm", pose.external_reliability_mm}};
    if (pose.rig_from_patient)
        json["rig_from_patient"] = json_of(*pose.rig_from_patient);
    else
        json["reason"] = pose.reason;
    return json;
}

Json json_of(const OverlayStep& overlay) {
    if (!overlay.lit) return {{"lit", false}, {"dark", overlay.reason}};
    return {{"lit", true},
            {"lit_from_ns", overlay.lit_from.count()},
            {"rig_from_ct", json_of(overlay.rig_from_ct)},
            {"points",
             {overlay.counts.points, overlay.counts.lit, overlay.counts.too_steep, overlay.counts.hidden,
              overlay.counts.outside}}};
}

/// Of the items whose light has a code in place of the name; nothing in recordings of plans without such.
void add_codes(const Session& session, Json& event) {
    const auto& items = session.drawing().items;
    if (std::none_of(items.begin(), items.end(), [](const DrawnItem& item) { return item.lit_by_code; })) return;
    event["codes"] = Json::array();
    for (const DrawnItem& item : items) event["codes"].push_back(item.lit_by_code ? item.code : "");
}

/// Of every item in their order; nothing in recordings of plans without risk structures, as they always were.
void add_risks(const Session& session, Json& event) {
    if (session.plan().risk_structures.empty()) return;
    event["risk"] = Json::array();
    for (const DrawnItem& item : session.drawing().items)
        event["risk"].push_back(Json(clearances_json(item.clearances)));
}

Json item_names(const Session& session) {
    Json names = Json::array();
    for (const DrawnItem& item : session.drawing().items) names.push_back(item.name);
    return names;
}

}  // namespace

const char* word_of(LightTrust trust) {
    return kTrusts[static_cast<std::size_t>(trust)];
}

const char* word_of(LightFault fault) {
    return kFaults[static_cast<std::size_t>(fault)];
}

const char* word_of(SessionCall call) {
    return kCalls[static_cast<std::size_t>(call)];
}

const char* word_of(GateCall call) {
    return kGateCalls[static_cast<std::size_t>(call)];
}

bool from_word(const std::string& word, SessionCall& call) {
    return find_word(kCalls, word, call);
}

bool from_word(const std::string& word, GateCall& call) {
    return find_word(kGateCalls, word, call);
}

std::string asked(SessionCall call, const std::vector<PointPair>& landmarks, int which) {
    Json json = {{"what", "asked"}, {"call", word_of(call)}};
    if (call != SessionCall::update) json["utc"] = today();
    if (call == SessionCall::light_landmark || call == SessionCall::light_item || call == SessionCall::hide_item ||
        call == SessionCall::show_item)
        json["which"] = which;
    if (call == SessionCall::find_patient) {
        json["landmarks"] = Json::array();
        for (const PointPair& pair : landmarks)
            json["landmarks"].push_back(
                {{"name", pair.name}, {"in_ct", json_of(pair.in_ct)}, {"in_rig", json_of(pair.in_rig)}});
    }
    return text_of(json);
}

std::string scanned(const Session& session) {
    const ScanResult& scan = *session.scanned();
    Json markers = Json::array();
    for (const PatientMarker& marker : session.tracker().markers()) {
        Json row = json_of(marker.centre_in_patient);
        row.push_back(marker.sigma_mm);
        markers.push_back(row);
    }
    Json json = {
        {"what", "scanned"},  {"points", scan.clean.kept.size()},        {"cloud", hash_of(scan.clean.kept)},
        {"markers", markers}, {"moved_mm", session.motion_in_scan_mm()}, {"repeated", session.scans_repeated()},
        {"rig", nullptr}};
    if (const RigState* rig = session.rig_state())
        json["rig"] = {{"verdict", static_cast<int>(rig->verdict)},
                       {"sentence", rig->sentence},
                       {"hash", planlight::hash_of(rig->rig)},
                       {"capture", rig->capture_hash},
                       {"hidden_light_mm", rig->hidden_light_mm}};
    return text_of(json);
}

std::string matched(const Session& session) {
    const RegistrationResult& found = *session.registration();
    Json json = {{"what", "matched"},
                 {"verdict", kVerdicts[static_cast<std::size_t>(found.verdict)]},
                 {"reasons", found.reasons},
                 {"patient_from_ct", json_of(found.patient_from_ct)},
                 {"residual_rms_mm", found.residual_rms_mm},
                 {"residual_median_mm", found.residual_median_mm},
                 {"inlier_fraction", found.inlier_fraction},
                 {"points", found.points},
                 {"runner_up_ratio", found.runner_up_ratio},
                 {"agreeing_bases", found.agreeing_bases},
                 {"mirror_ratio", found.mirror_ratio},
                 {"skin_offset_mm", found.skin_offset_mm ? Json(*found.skin_offset_mm) : Json()},
                 {"skin_movement_mm", found.skin_movement_mm ? Json(*found.skin_movement_mm) : Json()},
                 {"landmarks_off_mm", found.landmarks_off_mm ? Json(*found.landmarks_off_mm) : Json()}};
    json["items"] = Json::array();
    json["predicted_mm"] = Json::array();
    if (found.verdict != Verdict::no) {
        for (const double mm : predicted_errors_mm(session.plan(), found)) json["predicted_mm"].push_back(mm);
        for (const DrawnItem& item : session.drawing().items) json["items"].push_back(item.name);
        add_codes(session, json);
        add_risks(session, json);
    }
    return text_of(json);
}

std::string updated(const Session& session, const Session::Update& update) {
    Json json = {{"what", "updated"},
                 {"number", update.frame.number},
                 {"at_ns", update.frame.at.count()},
                 {"exposure_ns", update.frame.exposure.count()},
                 {"pose", json_of(update.pose)},
                 {"light", json_of(update.overlay)},
                 {"delay_ns", session.found_delay().count()}};
    if (update.light) json["check"] = json_of(*update.light);
    if (!update.causes.empty()) {
        json["causes"] = Json::array();
        for (const LightCause& cause : update.causes) json["causes"].push_back(json_of(cause));
    }
    return text_of(json);
}

std::string skin_checked(const SkinCheck& check) {
    Json json = {{"what", "skin_checked"},
                 {"known", check.known},
                 {"why_not", check.why_not},
                 {"points", check.points},
                 {"off_mm", check.off_mm},
                 {"bound_mm", check.bound_mm},
                 {"moved_meanwhile_mm", check.moved_meanwhile_mm}};
    if (check.elsewhere) json["elsewhere"] = true;
    return text_of(json);
}

std::string resumed(const Session& session, const ResumeCheck& check) {
    const RegistrationResult& found = *session.registration();
    Json json = {{"what", "resumed"},
                 {"verdict", kVerdicts[static_cast<std::size_t>(found.verdict)]},
                 {"patient_from_ct", json_of(found.patient_from_ct)},
                 {"markers", check.markers},
                 {"marker_off_mm", check.marker_off_mm},
                 {"moved_meanwhile_mm", check.moved_meanwhile_mm},
                 {"light_moved_mm", check.light_moved_mm},
                 {"points", check.points},
                 {"cloud", hash_of(*check.cloud)},
                 {"residual_mm", check.residual_mm},
                 {"skin_off_mm", check.skin_off_mm},
                 {"bound_mm", check.bound_mm},
                 {"items", item_names(session)},
                 {"predicted_mm", predicted_errors_mm(session.plan(), found)}};
    add_codes(session, json);
    add_risks(session, json);
    return text_of(json);
}

std::string refused(SessionCall call, const std::exception& why) {
    return text_of({{"what", "refused"}, {"call", word_of(call)}, {"why", why.what()}});
}

std::string gate(GateCall call, Instant at, double off_mm, const LightGate::Ruling* ruling) {
    Json json = {{"what", "gate"}, {"call", word_of(call)}};
    if (call == GateCall::verify) json["at_ns"] = at.count(), json["utc"] = today();
    if (call == GateCall::other_light) json["at_ns"] = at.count();
    if (call == GateCall::skin_checked) json["off_mm"] = std::isfinite(off_mm) ? Json(off_mm) : Json();
    if (!ruling) return text_of(json);
    json["at_ns"] = at.count();
    json["trust"] = word_of(ruling->trust);
    json["headline"] = ruling->headline;
    json["details"] = ruling->details;
    json["ask_to_verify"] = ruling->ask_to_verify;
    json["stop"] = ruling->stop;
    json["off_mm"] = ruling->off_mm ? Json(*ruling->off_mm) : Json();
    json["sigma_mm"] = ruling->sigma_mm ? Json(*ruling->sigma_mm) : Json();
    return text_of(json);
}

double skin_off_mm(const Json& event) {
    const auto off = event.find("off_mm");
    if (off == event.end()) return 0;
    return off->is_null() ? std::numeric_limits<double>::infinity() : off->get<double>();
}

std::string pressed(const std::string& action) {
    return text_of({{"what", "pressed"}, {"action", action}, {"utc", today()}});
}

std::string said(const std::string& kind, const std::string& headline, const std::vector<std::string>& details) {
    return text_of({{"what", "said"}, {"kind", kind}, {"headline", headline}, {"details", details}});
}

std::string room(const RoomFacts& room) {
    return text_of({{"name", room.name},
                    {"simulated", room.kind == RoomKind::simulated},
                    {"recorded", room.kind == RoomKind::recorded},
                    {"disc_mm", room.markers.disc_diameter_mm},
                    {"sticker_mm", room.markers.sticker_diameter_mm},
                    {"rig", Json::parse(planlight::text_of(room.rig))},
                    {"rig_hash", planlight::hash_of(room.rig)},
                    {"notes", room.notes},
                    {"clock_ns", room.now.count()},
                    {"utc", today()}});
}

RoomKind room_kind_of(const Json& room) {
    if (room.value("recorded", false)) return RoomKind::recorded;
    return room.value("simulated", false) ? RoomKind::simulated : RoomKind::real;
}

}  // namespace planlight::session_events
