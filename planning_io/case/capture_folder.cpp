#include "planning_io/case/capture_folder.h"

#include <algorithm>

#include "planning_io/case/recording_json.h"
#include "planning_io/files/image_file.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using namespace recording;

/// NAME.png, or NAME.tif, NAME.tiff where that is there instead.
fs::path picture_file(const fs::path& folder, const std::string& name) {
    for (const char* ending : {".tif", ".tiff"})
        if (!fs::exists(folder / (name + ".png")) && fs::exists(folder / (name + ending)))
            return folder / (name + ending);
    return folder / (name + ".png");
}

/// The picture at left/ or right/ of a recording; one size for all.
void read_picture(std::vector<GrayImage>& pictures, const fs::path& file) {
    pictures.push_back(read_gray(file));
    check_same_size(pictures.back(), pictures.front(), file);
}

/// The devices' serials in capture.json.
constexpr std::pair<const char*, std::string DeviceSerials::*> kSerials[] = {
    {"left_serial", &DeviceSerials::left_camera},
    {"right_serial", &DeviceSerials::right_camera},
    {"projector_serial", &DeviceSerials::projector}};

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
    root.has_only({"format", "version", "projector_width", "projector_height", "phase_steps", "phase_period_px", "rows",
                   "inverse", "began_ns", "ended_ns", "names", "order_periods_px", "order_steps", "check_sequence",
                   "left_serial", "right_serial", "projector_serial"});
    CaptureFolder capture;
    capture.projector_width = static_cast<int>(root.at("projector_width").integer(1, 65535));
    capture.projector_height = static_cast<int>(root.at("projector_height").integer(1, 65535));
    capture.phase_steps = static_cast<int>(root.at("phase_steps").integer(0, 1000));
    if (capture.phase_steps > 0 || root.find("phase_period_px"))  // a Gray code without fringes has none
        capture.phase_period_px = root.at("phase_period_px").number(0, 1e5);
    if (const auto periods = root.find("order_periods_px")) {
        if (periods->size() > 8) periods->refuse("must be a list of at most 8 periods");
        for (std::size_t i = 0; i < periods->size(); ++i)
            capture.order_periods_px.push_back((*periods)[i].number(0, 1e5));
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

}  // namespace planlight
