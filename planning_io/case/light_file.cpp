#include "planning_io/case/light_file.h"

#include <fmt/format.h>

#include <limits>

#include "planning_io/files/json_value.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr int kVersion = 1;
constexpr std::int64_t kAny = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kDay_ns = 86'400'000'000'000;

Instant instant_of(const JsonValue& value) {
    return Instant(value.integer(-kAny, kAny));
}

LightOrder order_of(const JsonValue& value) {
    value.has_only({"at_ns", "colour", "returned_ns", "promised_ns", "covered"});
    LightOrder order;
    order.at = instant_of(value.at("at_ns"));
    if (const auto returned = value.find("returned_ns")) order.returned = instant_of(*returned);
    if (const auto promised = value.find("promised_ns")) order.promised = instant_of(*promised);
    if (const auto covered = value.find("covered")) order.covered = covered->flag();
    const JsonValue colour = value.at("colour");
    if (colour.size() != 3) colour.refuse("is not three numbers", "A colour is red, green, blue, each 0 to 255.");
    for (std::size_t c = 0; c < 3; ++c) order.colour[c] = static_cast<std::uint8_t>(colour[c].integer(0, 255));
    return order;
}

LightFile::Frame frame_of(const JsonValue& value) {
    value.has_only({"picture", "number", "at_ns", "exposure_ns"});
    LightFile::Frame frame;
    frame.picture = value.at("picture").text();
    if (frame.picture.empty() || frame.picture.size() > 100 || frame.picture.front() == '.' ||
        frame.picture.find_first_of("/\\") != std::string::npos)
        value.at("picture").refuse("is no plain file name", "Name a picture that lies in left/ (and right/).");
    frame.number = static_cast<std::uint64_t>(value.at("number").integer(0, kAny));
    frame.at = instant_of(value.at("at_ns"));
    frame.exposure = Instant(value.at("exposure_ns").integer(0, kDay_ns));
    return frame;
}

}  // namespace

void write_light_file(const LightFile& light, const fs::path& folder) {
    Json orders = Json::array(), frames = Json::array();
    for (const LightOrder& order : light.orders) {
        Json json{{"at_ns", order.at.count()}, {"colour", order.colour}};
        if (order.returned) json["returned_ns"] = order.returned->count();
        if (order.promised) json["promised_ns"] = order.promised->count();
        if (order.covered) json["covered"] = true;
        orders.push_back(std::move(json));
    }
    for (const LightFile::Frame& frame : light.frames)
        frames.push_back(Json{{"picture", frame.picture},
                              {"number", frame.number},
                              {"at_ns", frame.at.count()},
                              {"exposure_ns", frame.exposure.count()}});
    write_safely(folder / "light.json", dump(Json{{"format", "planlight light"},
                                                  {"version", kVersion},
                                                  {"settle_ns", light.settle.count()},
                                                  {"orders", std::move(orders)},
                                                  {"frames", std::move(frames)}}));
}

LightFile read_light_file(const fs::path& folder) {
    const fs::path file = folder / "light.json";
    const Json json = parse_json(read_whole(file), file);
    const JsonValue root(json, file);
    check_format(root, "planlight light", kVersion, file);
    root.has_only({"format", "version", "settle_ns", "orders", "frames"});
    LightFile light;
    if (const auto settle = root.find("settle_ns")) light.settle = Instant(settle->integer(0, kDay_ns));
    const JsonValue orders = root.at("orders"), frames = root.at("frames");
    for (std::size_t i = 0; i < orders.size(); ++i) {
        light.orders.push_back(order_of(orders[i]));
        if (i > 0 && light.orders[i].at < light.orders[i - 1].at)
            orders[i].at("at_ns").refuse("is before the order before it");
    }
    for (std::size_t i = 0; i < frames.size(); ++i) {
        light.frames.push_back(frame_of(frames[i]));
        if (i > 0 && light.frames[i].at < light.frames[i - 1].at)
            frames[i].at("at_ns").refuse("is before the frame before it");
    }
    if (light.orders.empty() || light.frames.empty())
        throw InputError(file, fmt::format("has {} orders and {} frames", light.orders.size(), light.frames.size()),
                         "Record what the projector showed, and the cameras meanwhile.");
    return light;
}

ProjectorFacts read_projector_file(const fs::path& file) {
    const Json json = parse_json(read_whole(file), file);
    const JsonValue root(json, file);
    check_format(root, "planlight projector", kVersion, file);
    ProjectorFacts facts;
    facts.made_on = root.at("made_on").text();
    const JsonValue projector = root.at("projector");
    projector.has_only({"width", "height", "monitor", "serial"});
    const auto size = [&](const char* key) {
        const auto value = projector.find(key);
        return value ? static_cast<int>(value->integer(0, 65535)) : 0;
    };
    facts.width = size("width");
    facts.height = size("height");
    if (const auto monitor = projector.find("monitor")) facts.monitor = monitor->text();
    if (const auto serial = projector.find("serial")) facts.serial = serial->text();
    if (const auto latency = root.find("latency"))
        if (const auto delay = latency->find("light_delay_ms"))
            facts.light_delay = from_seconds(delay->number(0, 10000) / 1e3);
    return facts;
}

}  // namespace planlight
