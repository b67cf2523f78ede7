#include "planning_io/case/registration_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "planning_io/case/recording_json.h"
#include "planning_io/case/rig_json.h"
#include "planning_io/files/content_hash.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using namespace recording;

const char* const kVerdicts[] = {"yes", "ask", "no"};

Verdict verdict_of(const JsonValue& value) {
    const std::string text = value.text();
    for (std::size_t i = 0; i < 3; ++i)
        if (text == kVerdicts[i]) return static_cast<Verdict>(i);
    value.refuse("is \"" + text + "\", none of yes, ask, no");
}

/// Null where it is not known.
Json json_of(const PoseCovariance& covariance) {
    if (!covariance.known() || !covariance.of_turn_and_shift.allFinite()) return Json();
    Json rows = Json::array();
    for (Eigen::Index i = 0; i < 36; ++i) rows.push_back(covariance.of_turn_and_shift(i / 6, i % 6));
    return {{"of_turn_and_shift", rows}, {"centre_in_ct", to_json(covariance.centre_in_ct)}};
}

/// A pose whose uncertainty nobody says may be off by anything.
PoseCovariance nothing_known() {
    PoseCovariance covariance;
    covariance.of_turn_and_shift.diagonal().setConstant(std::numeric_limits<double>::infinity());
    return covariance;
}

PoseCovariance covariance_of(const JsonValue& json) {
    PoseCovariance covariance;
    const JsonValue rows = json.at("of_turn_and_shift");
    if (rows.size() != 36)
        rows.refuse(fmt::format("holds {} numbers", rows.size()), "A covariance has 36, row by row.");
    for (Eigen::Index i = 0; i < 36; ++i)
        covariance.of_turn_and_shift(i / 6, i % 6) = rows[static_cast<std::size_t>(i)].number();
    covariance.centre_in_ct = json.at("centre_in_ct").vector3();
    return covariance;
}

Json json_of(const CaseName& name) {
    if (!name.known()) return Json();
    return {{"code", name.code}, {"volume_hash", name.volume_hash}, {"mesh_hash", name.mesh_hash}};
}

CaseName case_name_of(const JsonValue& value) {
    return {value.at("code").text(), value.at("volume_hash").text(), value.at("mesh_hash").text()};
}

/// Null where it is not known.
Json json_of(const std::optional<double>& value) {
    return value ? Json(*value) : Json();
}

/// Of all that stands in the file but itself: the spaces between the words do not matter.
std::string checksum_of(Json registration) {
    registration.erase("checksum");
    return content_hash(registration.dump());
}

/// A match whose file nobody vouches for is one that a person has to look at.
void judge_checksum(const Json& json, const JsonValue& root, const fs::path& file, RegistrationResult& result) {
    if (const auto checksum = root.find("checksum")) {
        if (checksum->text() == checksum_of(json)) return;
        throw DamagedFileError(file, "was changed after `planlight register` wrote it (its checksum differs)",
                               "Register the patient again, or copy the file again.");
    }
    if (result.verdict != Verdict::yes) return;
    result.verdict = Verdict::ask;
    result.reasons.push_back("The file has no checksum: nothing says that it is as `planlight register` wrote it.");
}

double rounded(double value, double step) {
    return std::round(value / step) * step;
}

/// Null where nothing is known of it. Places to 0.01 mm, distances to 0.0001 mm: finer than they are.
Json json_of(const SkinDisplacement& skin) {
    if (!skin.known()) return Json();
    Json places = Json::array();
    for (const auto& place : skin.places) {
        const Eigen::Vector3d& p = place.p_in_ct;
        places.push_back({rounded(p.x(), 0.01), rounded(p.y(), 0.01), rounded(p.z(), 0.01), rounded(place.mm, 1e-4),
                          std::max(1e-4, rounded(place.sigma_mm, 1e-4))});
    }
    Json covered = Json::array();
    for (const auto& cover : skin.covered) {
        const Eigen::Vector3d& p = cover.p_in_ct;
        covered.push_back({rounded(p.x(), 0.01), rounded(p.y(), 0.01), rounded(p.z(), 0.01), rounded(cover.mm, 0.01)});
    }
    Json json{{"apart_mm", skin.apart_mm},
              {"offset_mm", skin.offset_mm},
              {"spread_mm", skin.spread_mm},
              {"alike_over_mm", skin.alike_over_mm},
              {"places", places}};
    if (!covered.empty()) json["covered"] = covered;
    return json;
}

SkinDisplacement skin_of(const JsonValue& json) {
    constexpr double kLeast_mm = 1e-5, kFar_mm = 1e5, kMost_mm = 50;
    SkinDisplacement skin;
    skin.apart_mm = json.at("apart_mm").number(0.1, 100);
    skin.offset_mm = json.at("offset_mm").number(-kMost_mm, kMost_mm);
    skin.spread_mm = json.at("spread_mm").number(kLeast_mm, kMost_mm);
    skin.alike_over_mm = json.at("alike_over_mm").number(0.1, 1000);
    const JsonValue places = json.at("places");
    if (places.size() > 200000) places.refuse("holds more places than any scan has");
    skin.places.reserve(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
        const JsonValue row = places[i];
        if (row.size() != 5) row.refuse("is not five numbers: x, y, z in ct, the displacement and its sigma, mm");
        SkinDisplacement::Place place;
        for (std::size_t k = 0; k < 3; ++k)
            place.p_in_ct[static_cast<Eigen::Index>(k)] = row[k].number(-kFar_mm, kFar_mm);
        place.mm = row[3].number(-kMost_mm, kMost_mm);
        place.sigma_mm = row[4].number(kLeast_mm, kMost_mm);
        skin.places.push_back(place);
    }
    const auto covered = json.find("covered");
    if (!covered) return skin;
    if (covered->size() > 200000) covered->refuse("holds more places than any scan has");
    for (std::size_t i = 0; i < covered->size(); ++i) {
        const JsonValue row = (*covered)[i];
        if (row.size() != 4) row.refuse("is not four numbers: x, y, z in ct, and how far outside it is covered, mm");
        SkinDisplacement::Cover cover;
        for (std::size_t k = 0; k < 3; ++k)
            cover.p_in_ct[static_cast<Eigen::Index>(k)] = row[k].number(-kFar_mm, kFar_mm);
        cover.mm = row[3].number(-kMost_mm, kMost_mm);
        skin.covered.push_back(cover);
    }
    return skin;
}

}  // namespace

std::string text_of(const RegistrationResult& result) {
    Json json = Json{{"format", "planlight registration"},
                     {"version", kVersion},
                     {"verdict", kVerdicts[static_cast<std::size_t>(result.verdict)]},
                     {"reasons", result.reasons},
                     {"patient_from_ct", to_json(result.patient_from_ct)},
                     {"residual_rms_mm", result.residual_rms_mm},
                     {"residual_median_mm", result.residual_median_mm},
                     {"inlier_fraction", result.inlier_fraction},
                     {"inlier_distance_mm", result.inlier_distance_mm},
                     {"points", result.points},
                     {"judged_points", result.judged_points},
                     {"runner_up_ratio", std::min(result.runner_up_ratio, std::numeric_limits<double>::max())},
                     {"agreeing_bases", result.agreeing_bases},
                     {"weakest_sigma_mm", json_of(result.weakest_sigma_mm)},
                     {"mirror_ratio", std::min(result.mirror_ratio, std::numeric_limits<double>::max())},
                     {"skin_fraction", json_of(result.skin_fraction)},
                     {"blocked_fraction", json_of(result.blocked_fraction)},
                     {"landmarks_off_mm", json_of(result.landmarks_off_mm)},
                     {"moved_in_scan_mm", json_of(result.moved_in_scan_mm)},
                     {"scale", result.scale},
                     {"scale_sigma", result.scale_sigma},
                     {"skin_movement_mm", json_of(result.skin_movement_mm)},
                     {"skin_offset_mm", json_of(result.skin_offset_mm)},
                     {"shape_change_mm", json_of(result.shape_change_mm)},
                     {"covariance", json_of(result.covariance)},
                     {"initial_match_s", result.initial_match_s},
                     {"refine_s", result.refine_s},
                     {"initial_patient_from_ct", to_json(result.initial_patient_from_ct)},
                     {"skin_displacement", json_of(result.skin)}};
    json["case"] = json_of(result.of_case);
    json["rig"] = result.rig ? json_of(*result.rig) : Json();
    json["checksum"] = checksum_of(json);
    return dump(json);
}

void write_registration(const RegistrationResult& result, const fs::path& file) {
    write_safely(file, text_of(result));
}

RegistrationResult read_registration(const fs::path& file) {
    return registration_of_text(read_whole(file), file);
}

RegistrationResult registration_of_text(const std::string& text, const fs::path& file) {
    const Json json = parse_json(text, file);
    const JsonValue root(json, file);
    check_format(root, "planlight registration", kVersion, file);
    const auto number = [&](const char* key) {  // evidence may be absent or, where it was not finite, null
        const auto value = root.find(key);
        return value ? value->number() : 0.0;
    };
    const auto known = [&](const char* key) {
        const auto value = root.find(key);
        return value ? std::optional(value->number()) : std::nullopt;
    };
    RegistrationResult result;
    result.verdict = verdict_of(root.at("verdict"));
    const JsonValue reasons = root.at("reasons");
    for (std::size_t i = 0; i < reasons.size(); ++i) result.reasons.push_back(reasons[i].text());
    result.patient_from_ct = root.at("patient_from_ct").transform();
    if (const auto initial = root.find("initial_patient_from_ct"))
        result.initial_patient_from_ct = initial->transform();
    result.residual_rms_mm = number("residual_rms_mm");
    result.residual_median_mm = number("residual_median_mm");
    result.inlier_fraction = number("inlier_fraction");
    result.inlier_distance_mm = number("inlier_distance_mm");
    result.runner_up_ratio = number("runner_up_ratio");
    result.weakest_sigma_mm = known("weakest_sigma_mm");
    result.mirror_ratio = number("mirror_ratio");
    result.skin_fraction = known("skin_fraction");
    result.blocked_fraction = known("blocked_fraction");
    result.landmarks_off_mm = known("landmarks_off_mm");
    result.moved_in_scan_mm = known("moved_in_scan_mm");
    if (root.find("scale")) result.scale = number("scale");
    result.scale_sigma = number("scale_sigma");
    result.skin_movement_mm = known("skin_movement_mm");
    result.skin_offset_mm = known("skin_offset_mm");
    result.shape_change_mm = known("shape_change_mm");
    if (const auto skin = root.find("skin_displacement")) result.skin = skin_of(*skin);
    const auto covariance = root.find("covariance");
    result.covariance = covariance ? covariance_of(*covariance) : nothing_known();
    result.initial_match_s = number("initial_match_s");
    result.refine_s = number("refine_s");
    if (const auto points = root.find("points")) result.points = static_cast<std::size_t>(points->integer(0, kAny));
    if (const auto judged = root.find("judged_points"))
        result.judged_points = static_cast<std::size_t>(judged->integer(0, kAny));
    if (const auto bases = root.find("agreeing_bases"))
        result.agreeing_bases = static_cast<int>(bases->integer(0, 1000000000));
    if (const auto name = root.find("case")) result.of_case = case_name_of(*name);
    if (const auto rig = root.find("rig")) result.rig = rig_state_of(*rig);
    judge_checksum(json, root, file, result);
    return result;
}

}  // namespace planlight
