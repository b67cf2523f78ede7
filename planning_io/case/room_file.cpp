#include "planning_io/case/room_file.h"

#include <functional>

#include "planning_io/case/recording_json.h"
#include "planning_io/files/check_exists.h"
#include "planning_io/files/json_value.h"
#include "planning_io/files/safe_write.h"

namespace planlight {

using recording::kVersion;
using recording::parse_file;

namespace {

constexpr double kLeastDisc_mm = 2, kMostDisc_mm = 50, kLeastSticker = 1.2, kMostSticker_mm = 100;

constexpr const char* kFormat = "planlight room";

std::optional<double> number_in(const JsonValue& from, const char* key, double least, double most) {
    const auto value = from.find(key);
    return value ? std::optional(value->number(least, most)) : std::nullopt;
}

/// Former programs wrote it for every GenICam camera, beside `line`; now `line` alone says it.
void check_trigger(const JsonValue& camera) {
    const auto trigger = camera.find("trigger");
    if (!trigger) return;
    const std::string text = trigger->text();
    const bool line = camera.find("line").has_value();
    if (text == "line" && !line)
        trigger->refuse("names no line", "Name it: \"line\": \"Line0\"; `trigger` may be deleted.");
    if (text == "none" && line)
        trigger->refuse("is \"none\" beside a line", "Delete `trigger`, or `line` where the camera runs free.");
    if (text != "line" && text != "none")
        trigger->refuse("is no longer known as \"" + text + "\"",
                        "Delete `trigger`: a camera runs free, or by the `line` that it names.");
}

RoomCamera camera_of(const JsonValue& value) {
    value.has_only({"device", "pixel_format", "trigger", "line", "exposure_ms", "gain", "frames_hz", "transfer_ms",
                    "region", "global_shutter", "pipeline"});
    check_trigger(value);
    RoomCamera camera;
    if (const auto pipeline = value.find("pipeline")) camera.pipeline = pipeline->text();
    if (camera.pipeline.empty()) camera.device = value.at("device").text();
    if (camera.device.empty() && camera.pipeline.empty())
        value.refuse("names no camera",
                     "Give \"device\", the serial that `planlight devices` lists, or a \"pipeline\".");
    if (!camera.pipeline.empty())  // what is a GenICam camera's alone
        value.has_only({"pipeline", "exposure_ms", "transfer_ms"});
    if (const auto format = value.find("pixel_format")) camera.pixel_format = format->text();
    if (const auto line = value.find("line")) camera.line = line->text();
    camera.exposure_ms = number_in(value, "exposure_ms", 0.01, 10'000);
    camera.gain = number_in(value, "gain", -100, 1000);
    camera.frames_hz = number_in(value, "frames_hz", 0.1, 10'000);
    camera.transfer_ms = number_in(value, "transfer_ms", 0, 10'000);
    if (const auto global = value.find("global_shutter")) camera.global_shutter = global->flag();
    if (const auto region = value.find("region")) {
        if (region->size() != 4) region->refuse("is not [x, y, width, height]");
        camera.region.emplace();
        for (std::size_t i = 0; i < 4; ++i)
            (*camera.region)[i] = static_cast<int>((*region)[i].integer(i < 2 ? 0 : 16, 65535));
    }
    return camera;
}

Json json_of(const RoomCamera& camera) {
    Json json;
    if (camera.pipeline.empty()) {
        json["device"] = camera.device;
    } else {
        json["pipeline"] = camera.pipeline;
    }
    if (!camera.pixel_format.empty()) json["pixel_format"] = camera.pixel_format;
    if (!camera.line.empty()) json["line"] = camera.line;
    if (camera.exposure_ms) json["exposure_ms"] = *camera.exposure_ms;
    if (camera.gain) json["gain"] = *camera.gain;
    if (camera.frames_hz) json["frames_hz"] = *camera.frames_hz;
    if (camera.transfer_ms) json["transfer_ms"] = *camera.transfer_ms;
    if (camera.region) json["region"] = *camera.region;
    if (camera.global_shutter) json["global_shutter"] = *camera.global_shutter;
    return json;
}

using Beside = std::function<std::filesystem::path(const JsonValue&)>;

RoomRecording recording_of(const JsonValue& value, const Beside& beside) {
    value.has_only({"frames", "capture", "pace"});
    RoomRecording recording;
    if (const auto frames = value.find("frames")) recording.frames = beside(*frames);
    if (const auto capture = value.find("capture")) recording.capture = beside(*capture);
    if (recording.frames.empty() && recording.capture.empty())
        value.refuse("names no recording",
                     "Give \"frames\", a frames folder, or \"capture\", a capture folder, or both.");
    if (const auto pace = value.find("pace")) {
        if (pace->text() != "own" && pace->text() != "fastest")
            pace->refuse("is neither \"own\" nor \"fastest\"", "Write \"own\" for the pace of the recording.");
        recording.fastest = pace->text() == "fastest";
    }
    return recording;
}

Json json_of(const RoomRecording& recording) {
    Json json;
    if (!recording.frames.empty()) json["frames"] = recording.frames.string();
    if (!recording.capture.empty()) json["capture"] = recording.capture.string();
    json["pace"] = recording.fastest ? "fastest" : "own";
    return json;
}

void read_cameras(const JsonValue& cameras, const Beside& beside, RoomFile& room) {
    cameras.has_only({"left", "right", "recorded", "together", "max_apart_ms"});
    if (const auto together = cameras.find("together")) room.together = together->flag();
    room.max_apart_ms = number_in(cameras, "max_apart_ms", 0.01, 1000).value_or(room.max_apart_ms);
    if (const auto recorded = cameras.find("recorded")) {
        if (cameras.find("left") || cameras.find("right"))
            recorded->refuse("stands beside cameras", "Delete \"left\" and \"right\", or \"recorded\".");
        room.recorded = recording_of(*recorded, beside);
        return;
    }
    room.left = camera_of(cameras.at("left"));
    room.right = camera_of(cameras.at("right"));
    if (room.left.device == room.right.device && room.left.pipeline == room.right.pipeline)
        cameras.at("right").refuse("is the left camera as well", "Name two cameras.");
}

void read_projector(const JsonValue& projector, const Beside& beside, RoomFile& room) {
    projector.has_only({"monitor", "file"});
    room.monitor = projector.at("monitor").text();
    if (const auto measured = projector.find("file")) room.projector_file = beside(*measured);
}

}  // namespace

bool may_be_pasted(double disc_mm, double sticker_mm) {
    return disc_mm >= kLeastDisc_mm && disc_mm <= kMostDisc_mm && sticker_mm >= disc_mm * kLeastSticker &&
           sticker_mm <= kMostSticker_mm;
}

RoomFile read_room(const std::filesystem::path& file) {
    check_exists(file, "Check its name; `planlight devices --out room.json` writes a first one where cameras answer.");
    const Json json = parse_file(file, kFormat);
    const JsonValue root(json, file);
    root.has_only({"format", "version", "name", "rig", "projector", "cameras", "markers"});
    RoomFile room;
    const auto beside = [&](const JsonValue& path) {
        const std::filesystem::path given = path.text();
        return given.is_absolute() ? given : file.parent_path() / given;
    };
    if (const auto name = root.find("name")) room.name = name->text();
    room.rig = beside(root.at("rig"));
    read_cameras(root.at("cameras"), beside, room);
    if (!room.recorded || root.find("projector")) read_projector(root.at("projector"), beside, room);
    if (const auto markers = root.find("markers")) {
        markers->has_only({"disc_mm", "sticker_mm"});
        room.disc_mm = markers->at("disc_mm").number(kLeastDisc_mm, kMostDisc_mm);
        room.sticker_mm = markers->at("sticker_mm").number(room.disc_mm * kLeastSticker, kMostSticker_mm);
    }
    return room;
}

void write_room(const RoomFile& room, const std::filesystem::path& file) {
    Json json;
    json["format"] = kFormat;
    json["version"] = kVersion;
    json["name"] = room.name;
    json["rig"] = room.rig.string();
    if (!room.monitor.empty()) json["projector"]["monitor"] = room.monitor;
    if (!room.projector_file.empty()) json["projector"]["file"] = room.projector_file.string();
    if (room.recorded) {
        json["cameras"]["recorded"] = json_of(*room.recorded);
    } else {
        json["cameras"]["left"] = json_of(room.left);
        json["cameras"]["right"] = json_of(room.right);
    }
    json["cameras"]["together"] = room.together;
    json["cameras"]["max_apart_ms"] = room.max_apart_ms;
    json["markers"]["disc_mm"] = room.disc_mm;
    json["markers"]["sticker_mm"] = room.sticker_mm;
    write_safely(file, dump(json));
}

}  // namespace planlight
