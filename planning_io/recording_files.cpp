#include "planning_io/recording_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "planning_io/image_file.h"
#include "planning_io/json_value.h"
#include "planning_io/safe_write.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr int kVersion = 1;
constexpr std::int64_t kAny = std::numeric_limits<std::int64_t>::max();

/// A name that is a file name and nothing more.
void check_name(const std::string& name, const fs::path& file) {
    const bool plain = !name.empty() && name.size() <= 100 && std::all_of(name.begin(), name.end(), [](unsigned char c) {
        return std::isalnum(c) || c == '_' || c == '-';
    });
    if (!plain)
        throw InputError(file, "names a pattern \"" + name + "\"",
                         "Use letters, digits, _ and - in names of patterns only.");
}

/// NAME.png, or NAME.tif, NAME.tiff where that is there instead.
fs::path picture_file(const fs::path& folder, const std::string& name) {
    for (const char* ending : {".tif", ".tiff"})
        if (!fs::exists(folder / (name + ".png")) && fs::exists(folder / (name + ending))) return folder / (name + ending);
    return folder / (name + ".png");
}

/// The picture at left/ or right/ of a recording; one size for all.
void read_picture(std::vector<GrayImage>& pictures, const fs::path& file) {
    pictures.push_back(read_gray(file));
    check_same_size(pictures.back(), pictures.front(), file);
}

Json parse_file(const fs::path& file, const char* format) {
    Json json = parse_json(read_whole(file), file);
    check_format(JsonValue(json, file), format, kVersion, file);
    return json;
}

Instant instant_of(const JsonValue& value) { return Instant(value.integer(-kAny, kAny)); }

/// The devices' serials in capture.json.
constexpr std::pair<const char*, std::string DeviceSerials::*> kSerials[] = {{"left_serial", &DeviceSerials::left_camera},
                                                                             {"right_serial", &DeviceSerials::right_camera},
                                                                             {"projector_serial", &DeviceSerials::projector}};

const char* const kVerdicts[] = {"yes", "ask", "no"};

Verdict verdict_of(const JsonValue& value) {
    const std::string text = value.text();
    for (std::size_t i = 0; i < 3; ++i)
        if (text == kVerdicts[i]) return static_cast<Verdict>(i);
    value.refuse("is \"" + text + "\", none of yes, ask, no");
}

/// Absent or null where it is not known.
Json json_of(const PoseCovariance& covariance) {
    if (!covariance.known() || !covariance.of_turn_and_shift.allFinite()) return Json();
    Json rows = Json::array();
    for (Eigen::Index i = 0; i < 36; ++i) rows.push_back(covariance.of_turn_and_shift(i / 6, i % 6));
    return {{"of_turn_and_shift", rows}, {"centre_in_ct", to_json(covariance.centre_in_ct)}};
}

PoseCovariance covariance_of(const JsonValue& json) {
    PoseCovariance covariance;
    const JsonValue rows = json.at("of_turn_and_shift");
    if (rows.size() != 36) rows.refuse(fmt::format("holds {} numbers", rows.size()), "A covariance has 36, row by row.");
    for (Eigen::Index i = 0; i < 36; ++i) covariance.of_turn_and_shift(i / 6, i % 6) = rows[static_cast<std::size_t>(i)].number();
    covariance.centre_in_ct = json.at("centre_in_ct").vector3();
    return covariance;
}

}  // namespace

void write_capture(const CaptureFolder& capture, const fs::path& folder) {
    const bool right = !capture.right.empty();
    if (capture.left.size() != capture.names.size() || (right && capture.right.size() != capture.names.size()))
        throw InputError(folder, "the capture does not have one picture of each camera for each pattern",
                         "Capture the sequence again.");
    for (const std::string& name : capture.names) check_name(name, folder);
    write_folder_safely(folder, false, [&](const fs::path& into) {
        fs::create_directories(into / "left");
        if (right) fs::create_directories(into / "right");
        for (std::size_t i = 0; i < capture.names.size(); ++i) {
            write_png(capture.left[i], into / "left" / (capture.names[i] + ".png"));
            if (right) write_png(capture.right[i], into / "right" / (capture.names[i] + ".png"));
        }
        write_capture_settings(capture, into / "capture.json");
    });
}

void write_capture_settings(const CaptureFolder& capture, const fs::path& file) {
    Json settings{{"format", "planlight capture"},
                  {"version", kVersion},
                  {"projector_width", capture.projector_width},
                  {"projector_height", capture.projector_height},
                  {"phase_steps", capture.phase_steps},
                  {"phase_period_px", capture.phase_period_px},
                  {"rows", capture.rows},
                  {"inverse", capture.inverse},
                  {"check_sequence", capture.check_sequence},
                  {"began_ns", capture.began.count()},
                  {"ended_ns", capture.ended.count()},
                  {"names", capture.names}};
    if (!capture.order_periods_px.empty()) {
        settings["order_periods_px"] = capture.order_periods_px;
        settings["order_steps"] = capture.order_steps;
    }
    for (const auto& [key, serial] : kSerials)
        if (!(capture.serials.*serial).empty()) settings[key] = capture.serials.*serial;
    write_safely(file, dump(settings));
}

CaptureFolder read_capture_settings(const fs::path& file) {
    const Json json = parse_file(file, "planlight capture");
    const JsonValue root(json, file);
    root.has_only({"format", "version", "projector_width", "projector_height", "phase_steps", "phase_period_px", "rows", "inverse",
                   "began_ns", "ended_ns", "names", "order_periods_px", "order_steps", "check_sequence", "left_serial",
                   "right_serial", "projector_serial"});
    CaptureFolder capture;
    capture.projector_width = static_cast<int>(root.at("projector_width").integer(1, 65535));
    capture.projector_height = static_cast<int>(root.at("projector_height").integer(1, 65535));
    capture.phase_steps = static_cast<int>(root.at("phase_steps").integer(0, 1000));
    if (capture.phase_steps > 0 || root.find("phase_period_px"))  // a Gray code without fringes has none
        capture.phase_period_px = root.at("phase_period_px").number(0, 1e5);
    if (const auto periods = root.find("order_periods_px")) {
        if (periods->size() > 8) periods->refuse("must be a list of at most 8 periods");
        for (std::size_t i = 0; i < periods->size(); ++i) capture.order_periods_px.push_back((*periods)[i].number(0, 1e5));
        capture.order_steps = static_cast<int>(root.at("order_steps").integer(3, 1000));
    }
    capture.rows = root.at("rows").flag();
    capture.inverse = root.at("inverse").flag();
    if (const auto check = root.find("check_sequence")) capture.check_sequence = check->flag();
    if (const auto began = root.find("began_ns")) capture.began = instant_of(*began);
    if (const auto ended = root.find("ended_ns")) capture.ended = instant_of(*ended);
    for (const auto& [key, serial] : kSerials)
        if (const auto given = root.find(key)) capture.serials.*serial = given->text();
    const auto names = root.find("names");
    if (!names) return capture;
    if (names->size() == 0 || names->size() > 10000) names->refuse("must be a list of 1 to 10000 names");
    for (std::size_t i = 0; i < names->size(); ++i) {
        const std::string name = (*names)[i].text();
        check_name(name, file);
        if (std::count(capture.names.begin(), capture.names.end(), name) > 0) (*names)[i].refuse("is named twice");
        capture.names.push_back(name);
    }
    return capture;
}

CaptureFolder read_capture(const fs::path& folder) {
    CaptureFolder capture = read_capture_settings(folder / "capture.json");
    if (capture.names.empty())
        throw InputError(folder / "capture.json", "has no list of names",
                         "Name the pictures in the order of the sequence.");
    const bool right = fs::is_directory(folder / "right");
    for (const std::string& name : capture.names) {
        read_picture(capture.left, picture_file(folder / "left", name));
        if (right) read_picture(capture.right, picture_file(folder / "right", name));
    }
    check_depth(capture.left, picture_file(folder / "left", capture.names.front()));
    if (right) check_depth(capture.right, picture_file(folder / "right", capture.names.front()));
    return capture;
}

void write_frames(const std::vector<RecordedFrame>& frames, const fs::path& folder) {
    write_folder_safely(folder, false, [&](const fs::path& into) {
        fs::create_directories(into / "left");
        fs::create_directories(into / "right");
        Json list = Json::array();
        for (std::size_t i = 0; i < frames.size(); ++i) {
            const std::string name = fmt::format("{:06}.png", i);
            write_png(frames[i].left, into / "left" / name);
            write_png(frames[i].right, into / "right" / name);
            list.push_back(Json{{"picture", name},
                                {"number", frames[i].number},
                                {"at_ns", frames[i].at.count()},
                                {"exposure_ns", frames[i].exposure.count()}});
        }
        write_safely(into / "frames.json",
                     dump(Json{{"format", "planlight frames"}, {"version", kVersion}, {"frames", std::move(list)}}));
    });
}

std::vector<RecordedFrame> read_frames(const fs::path& folder) {
    const fs::path file = folder / "frames.json";
    const Json json = parse_file(file, "planlight frames");
    const JsonValue root(json, file);
    root.has_only({"format", "version", "frames"});
    const JsonValue list = root.at("frames");
    std::vector<RecordedFrame> frames(list.size());
    for (std::size_t i = 0; i < frames.size(); ++i) {
        RecordedFrame& frame = frames[i];
        list[i].has_only({"picture", "number", "at_ns", "exposure_ns"});
        const std::string name = list[i].at("picture").text();
        if (!name.ends_with(".png")) list[i].refuse("has a picture that is not a PNG file");
        check_name(name.substr(0, name.size() - 4), file);
        frame.number = static_cast<std::uint64_t>(list[i].at("number").integer(0, kAny));
        frame.at = instant_of(list[i].at("at_ns"));
        frame.exposure = Instant(list[i].at("exposure_ns").integer(0, kAny));
        if (i > 0 && frame.at <= frames[i - 1].at) list[i].at("at_ns").refuse("is not later than the frame before it");
        frame.left = read_gray(folder / "left" / name);
        frame.right = read_gray(folder / "right" / name);
        check_same_size(frame.left, frames.front().left, folder / "left" / name);
        check_same_size(frame.right, frames.front().right, folder / "right" / name);
    }
    return frames;
}

void write_registration(const RegistrationResult& result, const fs::path& file) {
    write_safely(file, dump(Json{{"format", "planlight registration"},
                                 {"version", kVersion},
                                 {"verdict", kVerdicts[static_cast<std::size_t>(result.verdict)]},
                                 {"reasons", result.reasons},
                                 {"patient_from_ct", to_json(result.patient_from_ct)},
                                 {"residual_rms_mm", result.residual_rms_mm},
                                 {"residual_median_mm", result.residual_median_mm},
                                 {"inlier_fraction", result.inlier_fraction},
                                 {"inlier_distance_mm", result.inlier_distance_mm},
                                 {"points", result.points},
                                 {"runner_up_ratio", std::min(result.runner_up_ratio, std::numeric_limits<double>::max())},
                                 {"agreeing_bases", result.agreeing_bases},
                                 {"weakest_sigma_mm", result.weakest_sigma_mm},
                                 {"mirror_ratio", std::min(result.mirror_ratio, std::numeric_limits<double>::max())},
                                 {"blocked_fraction", result.blocked_fraction ? Json(*result.blocked_fraction) : Json(nullptr)},
                                 {"landmarks_off_mm", result.landmarks_off_mm ? Json(*result.landmarks_off_mm) : Json(nullptr)},
                                 {"moved_in_scan_mm", result.moved_in_scan_mm ? Json(*result.moved_in_scan_mm) : Json(nullptr)},
                                 {"scale", result.scale},
                                 {"scale_sigma", result.scale_sigma},
                                 {"skin_movement_mm", result.skin_movement_mm},
                                 {"skin_offset_mm", result.skin_offset_mm},
                                 {"covariance", json_of(result.covariance)},
                                 {"initial_match_s", result.initial_match_s},
                                 {"refine_s", result.refine_s},
                                 {"initial_patient_from_ct", to_json(result.initial_patient_from_ct)}}));
}

RegistrationResult read_registration(const fs::path& file) {
    const Json json = parse_file(file, "planlight registration");
    const JsonValue root(json, file);
    const auto number = [&](const char* key) {  // evidence may be absent or, where it was not finite, null
        const auto value = root.find(key);
        return value ? value->number() : 0.0;
    };
    RegistrationResult result;
    result.verdict = verdict_of(root.at("verdict"));
    const JsonValue reasons = root.at("reasons");
    for (std::size_t i = 0; i < reasons.size(); ++i) result.reasons.push_back(reasons[i].text());
    result.patient_from_ct = root.at("patient_from_ct").transform();
    if (const auto initial = root.find("initial_patient_from_ct")) result.initial_patient_from_ct = initial->transform();
    result.residual_rms_mm = number("residual_rms_mm");
    result.residual_median_mm = number("residual_median_mm");
    result.inlier_fraction = number("inlier_fraction");
    result.inlier_distance_mm = number("inlier_distance_mm");
    result.runner_up_ratio = number("runner_up_ratio");
    result.weakest_sigma_mm = number("weakest_sigma_mm");
    result.mirror_ratio = number("mirror_ratio");
    if (const auto blocked = root.find("blocked_fraction")) result.blocked_fraction = blocked->number();
    if (const auto off = root.find("landmarks_off_mm")) result.landmarks_off_mm = off->number();
    if (const auto moved = root.find("moved_in_scan_mm")) result.moved_in_scan_mm = moved->number();
    if (root.find("scale")) result.scale = number("scale");
    result.scale_sigma = number("scale_sigma");
    result.skin_movement_mm = number("skin_movement_mm");
    result.skin_offset_mm = number("skin_offset_mm");
    if (const auto covariance = root.find("covariance")) result.covariance = covariance_of(*covariance);
    result.initial_match_s = number("initial_match_s");
    result.refine_s = number("refine_s");
    if (const auto points = root.find("points")) result.points = static_cast<std::size_t>(points->integer(0, kAny));
    if (const auto bases = root.find("agreeing_bases")) result.agreeing_bases = static_cast<int>(bases->integer(0, 1000000000));
    return result;
}

void write_poses(const std::vector<TrackedPose>& poses, const fs::path& file) {
    Json list = Json::array();
    for (const TrackedPose& pose : poses)
        list.push_back(Json{{"at_ns", pose.at.count()},
                            {"rig_from_patient", pose.rig_from_patient ? to_json(*pose.rig_from_patient) : Json(nullptr)},
                            {"markers_left", pose.markers_left},
                            {"markers_right", pose.markers_right},
                            {"residual_px", pose.residual_px},
                            {"predicted_error_mm", pose.predicted_error_mm},
                            {"reason", pose.reason}});
    write_safely(file, dump(Json{{"format", "planlight poses"}, {"version", kVersion}, {"poses", std::move(list)}}));
}

std::vector<TrackedPose> read_poses(const fs::path& file) {
    const Json json = parse_file(file, "planlight poses");
    const JsonValue root(json, file);
    root.has_only({"format", "version", "poses"});
    const JsonValue list = root.at("poses");
    std::vector<TrackedPose> poses(list.size());
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const JsonValue entry = list[i];
        entry.has_only({"at_ns", "rig_from_patient", "markers_left", "markers_right", "residual_px", "predicted_error_mm", "reason"});
        TrackedPose& pose = poses[i];
        pose.at = instant_of(entry.at("at_ns"));
        if (const auto transform = entry.find("rig_from_patient")) pose.rig_from_patient = transform->transform();
        pose.markers_left = static_cast<int>(entry.at("markers_left").integer(0, 10000));
        pose.markers_right = static_cast<int>(entry.at("markers_right").integer(0, 10000));
        if (const auto residual = entry.find("residual_px")) pose.residual_px = residual->number();
        if (const auto error = entry.find("predicted_error_mm")) pose.predicted_error_mm = error->number();
        if (const auto reason = entry.find("reason")) pose.reason = reason->text();
        if (!pose.rig_from_patient && pose.reason.empty()) entry.refuse("has neither a pose nor a reason why there is none");
    }
    return poses;
}

}  // namespace planlight
