#include "planning_io/case/board_captures.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "planning_io/files/image_file.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

std::optional<fs::path> find_picture(const fs::path& without_ending) {
    for (const char* ending : {".png", ".tif", ".tiff", ".jpg", ".bmp", ".PNG", ".TIF", ".TIFF", ".JPG", ".BMP"}) {
        fs::path file = without_ending;
        file += ending;
        if (fs::is_regular_file(file)) return file;
    }
    return std::nullopt;
}

GrayImage read_needed(const fs::path& without_ending) {
    const auto file = find_picture(without_ending);
    if (!file)
        throw InputError(
            without_ending.parent_path(),
            fmt::format("the picture \"{}\" is missing (.png, .tif, .jpg or .bmp)", without_ending.filename().string()),
            "Capture this pose again, the whole sequence.");
    return read_gray(*file);
}

std::vector<GrayImage> read_camera(const fs::path& pose, const char* camera, const std::vector<std::string>& names) {
    std::vector<GrayImage> pictures;
    if (names.empty()) {
        pictures.push_back(read_needed(find_picture(pose / camera) ? pose / camera : pose / camera / "white"));
        return pictures;
    }
    pictures.resize(names.size());
    tbb::parallel_for(std::size_t{0}, names.size(),
                      [&](std::size_t i) { pictures[i] = read_needed(pose / camera / names[i]); });
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (pictures[i].width != pictures.front().width || pictures[i].height != pictures.front().height)
            throw InputError(
                pose / camera / names[i],
                fmt::format("is {} x {} pixels, the first picture of this pose is {} x {}", pictures[i].width,
                            pictures[i].height, pictures.front().width, pictures.front().height),
                "Capture all pictures with the same settings.");
    }
    check_depth(pictures, *find_picture(pose / camera / names.front()));
    return pictures;
}

bool has_camera(const fs::path& pose, const char* camera) {
    return fs::is_directory(pose / camera) || find_picture(pose / camera).has_value();
}

}  // namespace

std::vector<fs::path> pose_folders(const fs::path& captures) {
    std::vector<fs::path> poses;
    if (fs::is_directory(captures))
        for (const auto& entry : fs::directory_iterator(captures))
            if (entry.is_directory() && has_camera(entry.path(), "left")) poses.push_back(entry.path());
    if (poses.empty())
        throw InputError(captures, "holds no pose folders with a left camera",
                         "Give a folder that holds one folder a pose, each with left/ (and right/) pictures.");
    std::sort(poses.begin(), poses.end());
    return poses;
}

std::optional<CaptureFolder> pose_settings(const fs::path& pose) {
    for (const fs::path& file : {pose / "capture.json", pose.parent_path() / "capture.json"})
        if (fs::exists(file)) return read_capture_settings(file);
    return std::nullopt;
}

std::vector<std::string> missing_pictures(const fs::path& pose, const std::vector<std::string>& names) {
    std::vector<std::string> missing;
    for (const std::string camera : {"left", "right"}) {
        if (!has_camera(pose, camera.c_str())) continue;
        for (const std::string& name : names)
            if (!find_picture(pose / camera / name)) missing.push_back((pose.filename() / camera / name).string());
    }
    return missing;
}

PosePictures read_pose(const fs::path& pose, const std::vector<std::string>& names) {
    PosePictures pictures;
    pictures.left = read_camera(pose, "left", names);
    if (has_camera(pose, "right")) pictures.right = read_camera(pose, "right", names);
    return pictures;
}

}  // namespace planlight
