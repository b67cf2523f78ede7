#include "app/kept_match.h"

#include "planning_io/case/registration_file.h"
#include "planning_io/files/json_value.h"

namespace planlight {
namespace {

constexpr const char* kFormat = "planlight kept match";

LitPart lit_part_of(const JsonValue& json) {
    constexpr std::int64_t kMostItems = 100000;
    LitPart lit;
    const JsonValue hidden = json.at("hidden");
    for (std::size_t i = 0; i < hidden.size(); ++i)
        lit.hidden.insert(static_cast<std::size_t>(hidden[i].integer(0, kMostItems)));
    if (const auto item = json.find("item_of_moment"))
        lit.item_of_moment = static_cast<std::size_t>(item->integer(0, kMostItems));
    lit.card = json.at("card").flag();
    return lit;
}

}  // namespace

std::string text_of(const KeptMatch& match) {
    Json markers = Json::array();
    for (const PatientMarker& marker : match.markers) {
        const Eigen::Vector3d& p = marker.centre_in_patient;
        markers.push_back({p.x(), p.y(), p.z(), marker.sigma_mm});
    }
    const LitPart& lit = match.lit;
    const Json json{{"format", kFormat},
                    {"version", 1},
                    {"made", match.made_utc},
                    {"plan_hash", match.plan_hash},
                    {"confirmed", match.confirmed},
                    {"lit",
                     {{"hidden", lit.hidden},
                      {"item_of_moment", lit.item_of_moment ? Json(*lit.item_of_moment) : Json()},
                      {"card", lit.card}}},
                    {"markers", markers},
                    {"registration", Json::parse(text_of(match.registration))}};
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

KeptMatch kept_match_of(const std::string& text, const std::filesystem::path& file) {
    constexpr double kFar_mm = 1e5, kMostSigma_mm = 100;
    const Json json = parse_json(text, file);
    const JsonValue root(json, file);
    check_format(root, kFormat, 1, file);
    KeptMatch match;
    match.made_utc = root.at("made").text();
    match.plan_hash = root.at("plan_hash").text();
    match.confirmed = root.at("confirmed").flag();
    if (const auto lit = root.find("lit")) match.lit = lit_part_of(*lit);
    const JsonValue markers = root.at("markers");
    for (std::size_t i = 0; i < markers.size(); ++i) {
        const JsonValue row = markers[i];
        if (row.size() != 4) row.refuse("is not four numbers: x, y, z in patient, and sigma, mm");
        PatientMarker marker;
        for (std::size_t k = 0; k < 3; ++k)
            marker.centre_in_patient[static_cast<Eigen::Index>(k)] = row[k].number(-kFar_mm, kFar_mm);
        marker.sigma_mm = row[3].number(0, kMostSigma_mm);
        match.markers.push_back(marker);
    }
    if (!root.find("registration")) root.refuse("has no \"registration\"");
    match.registration = registration_of_text(json["registration"].dump(), file);
    return match;
}

}  // namespace planlight
