#include "planning_io/case/capture_folder.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cctype>
#include <exception>
#include <mutex>

#include "planning_io/case/missing_pictures.h"
#include "planning_io/case/recording_json.h"
#include "planning_io/files/image_file.h"
#include "planning_io/files/make_folder.h"

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

/// The names of the pictures in a folder that can be names of the sequence, in order.
std::vector<std::string> names_in(const fs::path& folder) {
    std::vector<std::string> names;
    if (!fs::is_directory(folder)) return names;
    for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string ending = entry.path().extension(), name = entry.path().stem();
        const bool plain = !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
            return std::isalnum(c) || c == '_' || c == '-';
        });
        if (plain && (ending == ".png" || ending == ".tif" || ending == ".tiff")) names.push_back(name);
    }
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return names;
}

int count_of(const std::vector<std::string>& names, const std::string& begin) {
    return static_cast<int>(
        std::count_if(names.begin(), names.end(), [&](const std::string& n) { return n.starts_with(begin); }));
}

/// What capture.json does not say, as the names say it.
void fill_from_names(const JsonValue& root, const std::vector<std::string>& names, CaptureFolder& capture) {
    if (names.empty()) return;
    const auto ends_so = [](const std::string& n) { return n.ends_with("-inverse"); };
    if (!root.find("phase_steps")) capture.phase_steps = count_of(names, "column-phase-");
    if (!root.find("order_steps") && count_of(names, "column-phase2-") > 0)
        capture.order_steps = count_of(names, "column-phase2-");
    if (!root.find("rows")) capture.rows = count_of(names, "row-") > 0;
    if (!root.find("inverse")) capture.inverse = std::any_of(names.begin(), names.end(), ends_so);
}

std::vector<std::string> missing_in(const fs::path& folder, const std::vector<std::string>& names) {
    std::vector<std::string> missing;
    for (const std::string& name : names)
        if (!fs::exists(picture_file(folder, name))) missing.push_back(name);
    return missing;
}

/// Leaves out of the capture what cannot be used without the missing pictures. A right camera of which nothing is left
/// is none. Returns whether the right camera is still there.
bool leave_out_missing(const std::vector<std::string>& left, const std::vector<std::string>& right, bool has_right,
                       const fs::path& folder, const ReadCapture& how, CaptureFolder& capture) {
    std::vector<std::string> both = left;
    both.insert(both.end(), right.begin(), right.end());
    UsableNames usable = usable_without(capture, both);
    if (usable.names.empty() && has_right) usable = usable_without(capture, left), has_right = false;
    std::vector<std::string> files;
    for (const std::string& name : left) files.push_back("left/" + name);
    for (const std::string& name : right) files.push_back("right/" + name);
    const std::string problem = fmt::format(
        "{} missing: {}", files.size() == 1 ? "this picture is" : fmt::format("{} pictures are", files.size()),
        listed(files));
    const std::string rest =
        usable.names.empty() ? std::string("nothing can be read without them")
        : !has_right && !right.empty()
            ? fmt::format("the right camera's pictures are of no use without them{}",
                          left.empty() ? "" : ", nor these of the left: " + listed(usable.left_out))
            : fmt::format("these cannot be used without them: {}", listed(usable.left_out));
    if (usable.names.empty() || !how.allow_missing)
        throw InputError(folder, problem + "; " + rest,
                         usable.names.empty()
                             ? "Capture the sequence again, or copy the whole of it."
                             : "Copy or capture them again; to use the rest, as coarse as it is, leave all these names "
                               "out of \"names\" in capture.json, or use `planlight scan --allow-missing`.");
    if (how.warn) how.warn(problem + "; " + rest + ", and are left out");
    capture.names = usable.names;
    capture.rows = usable.rows;
    return has_right;
}

/// One camera's picture of every name, side by side; what is refused is the first in the order of the names.
class PictureReader {
public:
    explicit PictureReader(std::size_t all, const ReadCapture& how) : all_(all), how_(how) {}

    std::vector<GrayImage> read(const fs::path& folder, const std::vector<std::string>& names) {
        std::vector<GrayImage> pictures(names.size());
        std::vector<std::exception_ptr> refused(names.size());
        tbb::parallel_for(std::size_t{0}, names.size(), [&](std::size_t i) {
            try {
                pictures[i] = read_gray(picture_file(folder, names[i]));
            } catch (...) {
                refused[i] = std::current_exception();
            }
            const std::lock_guard lock(mutex_);
            ++done_;
            if (how_.progress) how_.progress(static_cast<double>(done_) / static_cast<double>(all_));
        });
        for (const auto& exception : refused)
            if (exception) std::rethrow_exception(exception);
        for (std::size_t i = 0; i < names.size(); ++i)
            check_same_size(pictures[i], pictures.front(), picture_file(folder, names[i]));
        check_depth(pictures, picture_file(folder, names.front()));
        return pictures;
    }

private:
    std::size_t all_, done_ = 0;
    const ReadCapture& how_;
    std::mutex mutex_;
};

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
        make_folder(into / "left");
        if (right) make_folder(into / "right");
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
    if (capture.begins_at_column != 0 || capture.begins_at_row != 0)
        settings["begins_at"] = {capture.begins_at_column, capture.begins_at_row};
    for (const auto& [key, serial] : kSerials)
        if (!(capture.serials.*serial).empty()) settings[key] = capture.serials.*serial;
    write_safely(file, dump(settings));
}

namespace {

void read_names(const JsonValue& names, const fs::path& file, CaptureFolder& capture) {
    if (names.size() == 0 || names.size() > 10000) names.refuse("must be a list of 1 to 10000 names");
    for (std::size_t i = 0; i < names.size(); ++i) {
        const std::string name = names[i].text();
        check_name(name, file);
        if (std::count(capture.names.begin(), capture.names.end(), name) > 0) names[i].refuse("is named twice");
        capture.names.push_back(name);
    }
}

void read_beginning(const JsonValue& root, CaptureFolder& capture) {
    const auto begins = root.find("begins_at");
    if (!begins) return;
    if (begins->size() != 2)
        begins->refuse("must be two whole numbers", "Give the code's number at the first column and the first row.");
    if (capture.phase_steps > 0)
        begins->refuse("is for a Gray code without fringes",
                       "Leave it out: fringes are counted from the first column and row.");
    capture.begins_at_column = static_cast<int>((*begins)[0].integer(0, 32767));
    capture.begins_at_row = static_cast<int>((*begins)[1].integer(0, 32767));
}

}  // namespace

CaptureFolder read_capture_settings(const fs::path& file) {
    const Json json = parse_file(file, "planlight capture");
    const JsonValue root(json, file);
    root.has_only({"format", "version", "projector_width", "projector_height", "phase_steps", "phase_period_px", "rows",
                   "inverse", "began_ns", "ended_ns", "names", "order_periods_px", "order_steps", "check_sequence",
                   "left_serial", "right_serial", "projector_serial", "begins_at"});
    CaptureFolder capture;
    capture.projector_width = static_cast<int>(root.at("projector_width").integer(1, 65535));
    capture.projector_height = static_cast<int>(root.at("projector_height").integer(1, 65535));
    if (const auto names = root.find("names")) read_names(*names, file, capture);
    fill_from_names(root, capture.names.empty() ? names_in(file.parent_path() / "left") : capture.names, capture);
    if (const auto steps = root.find("phase_steps")) capture.phase_steps = static_cast<int>(steps->integer(0, 1000));
    if (capture.phase_steps > 0 || root.find("phase_period_px"))  // a Gray code without fringes has none
        capture.phase_period_px = root.at("phase_period_px").number(0, 1e5);
    if (const auto periods = root.find("order_periods_px")) {
        if (periods->size() > 8) periods->refuse("must be a list of at most 8 periods");
        for (std::size_t i = 0; i < periods->size(); ++i)
            capture.order_periods_px.push_back((*periods)[i].number(0, 1e5));
    }
    if (const auto steps = root.find("order_steps")) capture.order_steps = static_cast<int>(steps->integer(3, 1000));
    if (const auto rows = root.find("rows")) capture.rows = rows->flag();
    if (const auto inverse = root.find("inverse")) capture.inverse = inverse->flag();
    read_beginning(root, capture);
    if (const auto check = root.find("check_sequence")) capture.check_sequence = check->flag();
    if (const auto began = root.find("began_ns")) capture.began = instant_of(*began);
    if (const auto ended = root.find("ended_ns")) capture.ended = instant_of(*ended);
    for (const auto& [key, serial] : kSerials)
        if (const auto given = root.find(key)) capture.serials.*serial = given->text();
    return capture;
}

CaptureFolder read_capture(const fs::path& folder, const ReadCapture& how) {
    CaptureFolder capture = read_capture_settings(folder / "capture.json");
    if (capture.names.empty()) capture.names = names_in(folder / "left");
    if (capture.names.empty())
        throw InputError(folder / "capture.json", "has no list of names, and there are no pictures in left/",
                         "Name the pictures in the order of the sequence.");
    bool right = fs::is_directory(folder / "right");
    const auto missing_left = missing_in(folder / "left", capture.names),
               missing_right = right ? missing_in(folder / "right", capture.names) : std::vector<std::string>{};
    if (!missing_left.empty() || !missing_right.empty())
        right = leave_out_missing(missing_left, missing_right, right, folder, how, capture);
    PictureReader reader(capture.names.size() * (right ? 2 : 1), how);
    capture.left = reader.read(folder / "left", capture.names);
    if (right) capture.right = reader.read(folder / "right", capture.names);
    return capture;
}

}  // namespace planlight
