#include "app/live/recorded_room.h"

#include <algorithm>
#include <map>
#include <string_view>

#include "app/commands/capture_conversion.h"
#include "planning_io/case/frames_folder.h"
#include "planning_io/files/check_exists.h"
#include "planning_io/files/image_file.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

constexpr Instant kUsualExposure = std::chrono::milliseconds(10);  // a capture does not say it

std::size_t hash_of(const RgbImage& picture) {
    return std::hash<std::string_view>()(
        {reinterpret_cast<const char*>(picture.pixels.data()), picture.pixels.size() * sizeof(Rgb)});
}

/// Which picture of the capture belongs to a picture of its sequence that is shown.
RecordedProjector::Which which_of(const CaptureFolder& capture, const std::filesystem::path& folder) {
    const StripeSettings stripes = stripes_of(capture);
    std::map<std::size_t, std::size_t> known;
    for (const StripePattern& pattern : patterns_of(stripes, folder)) {
        const auto named = std::find(capture.names.begin(), capture.names.end(), pattern.name);
        if (named == capture.names.end()) continue;
        known[hash_of(draw_stripes(stripes, pattern))] = static_cast<std::size_t>(named - capture.names.begin());
    }
    return [known = std::move(known)](const RgbImage& picture) -> std::optional<std::size_t> {
        const auto found = known.find(hash_of(picture));
        return found == known.end() ? std::nullopt : std::optional(found->second);
    };
}

/// The scan's pictures, and as the only frame what the cameras saw of no light.
void take_scan(const std::filesystem::path& folder, RecordedRoom& room) {
    check_exists(folder,
                 "Check \"capture\" in room.json; `planlight capture` and `planlight simulate` write such a "
                 "folder.");
    CaptureFolder capture = read_capture(folder);
    if (capture.right.empty())
        throw InputError(folder, "has the left camera's pictures only", "Name a capture of two cameras.");
    room.which = which_of(capture, folder);
    room.projector_width = capture.projector_width;
    room.projector_height = capture.projector_height;
    room.serials = capture.serials;
    const auto black = std::find(capture.names.begin(), capture.names.end(), "black");
    const auto dark = black == capture.names.end() ? 0 : static_cast<std::size_t>(black - capture.names.begin());
    room.frames = {{{}, kUsualExposure, dark, 0}};
    room.left = std::move(capture.left);
    room.right = std::move(capture.right);
}

void take_frames(const std::filesystem::path& folder, RecordedRoom& room) {
    check_exists(folder, "Check \"frames\" in room.json; `planlight simulate` writes such a folder.");
    std::vector<StereoFrame> frames = read_frames(folder);
    if (frames.empty()) throw InputError(folder, "holds no frame", "Name a folder of frames that was recorded.");
    room.frames.clear();
    std::uint64_t before = frames.front().number;
    for (StereoFrame& frame : frames) {
        const std::size_t lost = frame.number > before + 1 ? static_cast<std::size_t>(frame.number - before - 1) : 0;
        room.frames.push_back({frame.at, frame.exposure, room.left.size(), lost});
        before = frame.number;
        room.left.push_back(std::move(frame.left));
        room.right.push_back(std::move(frame.right));
        check_same_size(room.left.back(), room.left.front(), folder / "left");
        check_same_size(room.right.back(), room.right.front(), folder / "right");
    }
}

}  // namespace

RecordedRoom read_recorded_room(const RoomRecording& recording) {
    RecordedRoom room;
    if (!recording.capture.empty()) take_scan(recording.capture, room);
    if (!recording.frames.empty()) take_frames(recording.frames, room);
    return room;
}

}  // namespace planlight
