#include "planning_io/case/poses_file.h"

#include <fmt/format.h>

#include "planning_io/case/recording_json.h"
#include "planning_io/case/rig_json.h"
#include "planning_io/files/content_hash.h"

namespace planlight {

namespace fs = std::filesystem;
using namespace recording;

namespace {

Json json_of(const PosesOrigin& origin) {
    return {{"calibrated", json_of(origin.calibrated)},
            {"capture_hash", origin.capture_hash},
            {"left_camera", json_of(origin.rig.left_camera)},
            {"right_camera", json_of(origin.rig.right_camera)}};
}

/// Of poses and origin: notes may be added, and spaces between the words do not matter.
std::string checksum_of(const Json& file) {
    return content_hash(Json{{"origin", file.at("origin")}, {"poses", file.at("poses")}}.dump());
}

/// What says that `track` measured it must be as `track` wrote it. Throws DamagedFileError.
void check_checksum(const Json& json, const JsonValue& root, const fs::path& file) {
    if (!root.find("origin")) return;  // another program's: nobody vouches for it, and `project` says so
    root.at("poses");
    const auto checksum = root.find("checksum");
    if (checksum && checksum->text() == checksum_of(json)) return;
    throw DamagedFileError(file,
                           checksum ? "was changed after `planlight track` wrote it (its checksum differs)"
                                    : "has no checksum: it was changed, or an earlier version of Planlight wrote it",
                           "Track the frames again, or copy the file again.");
}

}  // namespace

void write_poses(const std::vector<TrackedPose>& poses, const fs::path& file,
                 const std::optional<PosesOrigin>& origin) {
    Json list = Json::array();
    for (const TrackedPose& pose : poses)
        list.push_back(
            Json{{"at_ns", pose.at.count()},
                 {"rig_from_patient", pose.rig_from_patient ? to_json(*pose.rig_from_patient) : Json(nullptr)},
                 {"markers_left", pose.markers_left},
                 {"markers_right", pose.markers_right},
                 {"residual_px", pose.residual_px},
                 {"predicted_error_mm", pose.predicted_error_mm},
                 {"bound_95_mm", pose.bound_95_mm},
                 {"external_reliability_mm", pose.external_reliability_mm},
                 {"reason", pose.reason}});
    Json json{{"format", "planlight poses"}, {"version", kVersion}};
    if (origin) json["origin"] = json_of(*origin);
    json["poses"] = std::move(list);
    if (origin) json["checksum"] = checksum_of(json);
    write_safely(file, dump(json));
}

std::vector<TrackedPose> read_poses(const fs::path& file) {
    const Json json = parse_file(file, "planlight poses");
    const JsonValue root(json, file);
    root.has_only({"format", "version", "origin", "poses", "checksum"});
    check_checksum(json, root, file);
    const JsonValue list = root.at("poses");
    std::vector<TrackedPose> poses(list.size());
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const JsonValue entry = list[i];
        entry.has_only({"at_ns", "rig_from_patient", "markers_left", "markers_right", "residual_px",
                        "predicted_error_mm", "bound_95_mm", "external_reliability_mm", "reason"});
        TrackedPose& pose = poses[i];
        pose.at = instant_of(entry.at("at_ns"));
        if (const auto transform = entry.find("rig_from_patient")) pose.rig_from_patient = transform->transform();
        pose.markers_left = static_cast<int>(entry.at("markers_left").integer(0, 10000));
        pose.markers_right = static_cast<int>(entry.at("markers_right").integer(0, 10000));
        if (const auto residual = entry.find("residual_px")) pose.residual_px = residual->number();
        if (const auto error = entry.find("predicted_error_mm")) pose.predicted_error_mm = error->number();
        if (const auto bound = entry.find("bound_95_mm")) pose.bound_95_mm = bound->number();
        if (const auto reach = entry.find("external_reliability_mm")) pose.external_reliability_mm = reach->number();
        if (const auto reason = entry.find("reason")) pose.reason = reason->text();
        if (!pose.rig_from_patient && pose.reason.empty())
            entry.refuse("has neither a pose nor a reason why there is none");
    }
    return poses;
}

std::optional<PosesOrigin> read_poses_origin(const fs::path& file) {
    const Json json = parse_file(file, "planlight poses");
    const auto origin = JsonValue(json, file).find("origin");
    if (!origin) return std::nullopt;
    origin->has_only({"calibrated", "capture_hash", "left_camera", "right_camera"});
    PosesOrigin found;
    found.calibrated = rig_name_of(origin->at("calibrated"));
    found.capture_hash = origin->at("capture_hash").text();
    found.rig.left_camera = camera_model_of(origin->at("left_camera"));
    found.rig.right_camera = camera_model_of(origin->at("right_camera"));
    return found;
}

}  // namespace planlight
