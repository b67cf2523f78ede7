#include "app/live/light_source.h"

#include <fmt/format.h>

#include <charconv>
#include <map>

#include "planning_io/case/light_file.h"
#include "planning_io/files/image_file.h"
#include "planning_io/files/make_folder.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

LightRecording recorded(const std::string& part, const LightBench& bench, const RecordSettings& settings) {
    if (part == "response") return record_response(bench, settings);
    if (part == "cycle") return record_cycle(bench, settings);
    return record_latency(bench, settings);
}

}  // namespace

LightRecording read_light_folder(const fs::path& folder) {
    const LightFile light = read_light_file(folder);
    LightRecording recording;
    recording.settle = light.settle;
    recording.orders = light.orders;
    const bool right = fs::is_directory(folder / "right");
    GrayImage first_left, first_right;
    for (const LightFile::Frame& entry : light.frames) {
        StereoFrame frame;
        frame.number = entry.number;
        frame.at = entry.at;
        frame.exposure = entry.exposure;
        frame.left = read_gray(folder / "left" / entry.picture);
        if (right) frame.right = read_gray(folder / "right" / entry.picture);
        if (first_left.empty()) first_left = frame.left, first_right = frame.right;
        check_same_size(frame.left, first_left, folder / "left" / entry.picture);
        check_same_size(frame.right, first_right, folder / "right" / entry.picture);
        recording.frames.push_back(brightness_of(frame));
    }
    return recording;
}

LightRecording record_part(const std::string& part, LightBench bench, const RecordSettings& settings,
                           const fs::path& folder,
                           const std::function<void(const LightBench&, LightRecording&)>& afterwards) {
    const auto record = [&] {
        LightRecording recording = recorded(part, bench, settings);
        if (afterwards) afterwards(bench, recording);
        return recording;
    };
    if (folder.empty()) return record();
    LightRecording recording;
    write_folder_safely(folder, false, [&](const fs::path& into) {
        make_folder(into / "left");
        make_folder(into / "right");
        LightFile light;
        bench.keep = [&](const StereoFrame& frame) {
            const std::string name = fmt::format("{:06}.png", light.frames.size());
            write_png(frame.left, into / "left" / name);
            write_png(frame.right, into / "right" / name);
            light.frames.push_back({name, frame.number, frame.at, frame.exposure});
        };
        recording = record();
        light.settle = recording.settle;
        light.orders = recording.orders;
        write_light_file(light, into);
    });
    return recording;
}

void set_simulated_light(const std::vector<std::string>& words, simulation::BoardRoomSettings& room) {
    auto& light = room.light;
    const auto milliseconds = [](double v) { return from_seconds(v / 1e3); };
    const std::map<std::string, std::function<void(double)>> known{
        {"gamma", [&](double v) { light.panel.gamma = v; }},
        {"black", [&](double v) { light.panel.black = v; }},
        {"dark-end", [&](double v) { light.panel.dark_end = v / 255; }},
        {"bright-end", [&](double v) { light.panel.bright_end = v / 255; }},
        {"wheel-hz", [&](double v) { light.wheel_hz = v; }},
        {"mains-hz", [&](double v) { light.mains_hz = v; }},
        {"mains", [&](double v) { light.mains_depth = v / 100; }},
        {"delay-ms", [&](double v) { light.untold_delay = milliseconds(v); }},
        {"jitter-ms", [&](double v) { light.jitter = milliseconds(v); }},
        {"refresh-hz", [&](double v) { light.refresh_hz = v; }},
        {"skipped", [&](double v) { light.skipped_orders = v / 100; }},
        {"lost", [&](double v) { light.lost_frames = v / 100; }},
        {"brightness", [&](double v) { room.brightness = v; }},
        {"ambient", [&](double v) { room.ambient = v; }}};
    for (const std::string& word : words) {
        const auto equals = word.find('=');
        const auto name = known.find(word.substr(0, equals));
        double value = 0;
        const char* end = word.data() + word.size();
        if (name == known.end() || equals == std::string::npos ||
            std::from_chars(word.data() + equals + 1, end, value) != std::from_chars_result{end, std::errc{}} ||
            !(value >= 0)) {
            std::string names;
            for (const auto& [n, set] : known) names += (names.empty() ? "" : ", ") + n;
            throw InputError({}, "the simulated light knows no \"" + word + "\"",
                             "Write NAME=NUMBER with one of: " + names + ".");
        }
        name->second(value);
    }
}

}  // namespace planlight
