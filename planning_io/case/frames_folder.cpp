#include "planning_io/case/frames_folder.h"

#include <fmt/format.h>

#include <algorithm>

#include "planning_io/case/recording_json.h"
#include "planning_io/files/image_file.h"
#include "planning_io/files/make_folder.h"

namespace planlight {

namespace fs = std::filesystem;
using namespace recording;

void write_frames(const std::vector<StereoFrame>& frames, const fs::path& folder) {
    write_folder_safely(folder, false, [&](const fs::path& into) {
        make_folder(into / "left");
        make_folder(into / "right");
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

namespace {

/// As `check_depth`, of all pictures of one camera.
void check_depth_of(const std::vector<StereoFrame>& frames, GrayImage StereoFrame::*camera, const fs::path& folder,
                    const JsonValue& list) {
    const auto bright = [&](const StereoFrame& frame) { return brighter_than_low_bits(frame.*camera); };
    if (frames.empty() || std::ranges::any_of(frames, bright)) return;
    check_depth({frames.front().*camera}, folder / list[0].at("picture").text());
}

}  // namespace

std::vector<StereoFrame> read_frames(const fs::path& folder) {
    const fs::path file = folder / "frames.json";
    const Json json = parse_file(file, "planlight frames");
    const JsonValue root(json, file);
    root.has_only({"format", "version", "frames"});
    const JsonValue list = root.at("frames");
    std::vector<StereoFrame> frames(list.size());
    for (std::size_t i = 0; i < frames.size(); ++i) {
        StereoFrame& frame = frames[i];
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
    check_depth_of(frames, &StereoFrame::left, folder / "left", list);
    check_depth_of(frames, &StereoFrame::right, folder / "right", list);
    return frames;
}

}  // namespace planlight
