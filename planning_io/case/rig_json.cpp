#include "planning_io/case/rig_json.h"

#include <array>
#include <string>

namespace planlight {
namespace {

constexpr std::array kKeys{"left_camera", "right_camera", "projector"};  // by RigDevice
constexpr std::pair<const char*, std::string DeviceSerials::*> kSerials[] = {
    {"left_serial", &DeviceSerials::left_camera},
    {"right_serial", &DeviceSerials::right_camera},
    {"projector_serial", &DeviceSerials::projector}};

constexpr std::array kVerdicts{RigState::Verdict::unknown, RigState::Verdict::as_calibrated,
                               RigState::Verdict::corrected, RigState::Verdict::not_trusted};

RigState::Verdict verdict_of(const JsonValue& value) {
    const std::string text = value.text();
    for (const RigState::Verdict verdict : kVerdicts)
        if (text == text_of(verdict)) return verdict;
    value.refuse("is \"" + text + "\", none of unknown, as calibrated, corrected, not trusted");
}

Json json_of(const RigDoubt& doubt) {
    Json json{{"what", doubt.what}, {"chi_square", doubt.chi_square}, {"sigma", doubt.sigma}};
    for (std::size_t d = 0; d < kRigDevices; ++d) {
        Json numbers = Json::array();
        for (const double number : doubt.by[d]) numbers.push_back(number);
        json[kKeys[d]] = numbers;
    }
    return json;
}

RigDoubt doubt_of(const JsonValue& value) {
    RigDoubt doubt;
    doubt.what = value.at("what").text();
    doubt.chi_square = value.at("chi_square").number();
    doubt.sigma = value.at("sigma").flag();
    for (std::size_t d = 0; d < kRigDevices; ++d) {
        const JsonValue numbers = value.at(kKeys[d]);
        if (numbers.size() != static_cast<std::size_t>(DeviceChange::RowsAtCompileTime))
            numbers.refuse("must be 10 numbers");
        for (std::size_t i = 0; i < numbers.size(); ++i)
            doubt.by[d][static_cast<Eigen::Index>(i)] = numbers[i].number();
    }
    return doubt;
}

Json json_of(const DeviceFinding& finding) {
    return {{"moved", finding.moved},
            {"maybe", finding.maybe},
            {"best", finding.best},
            {"lens", finding.lens},
            {"moved_mm", finding.moved_mm},
            {"turned", finding.turned},
            {"focal_change", finding.focal_change}};
}

DeviceFinding finding_of(const JsonValue& value) {
    return {value.at("moved").flag(),         value.at("maybe").flag(),      value.at("best").flag(),
            value.at("lens").flag(),          value.at("moved_mm").number(), value.at("turned").number(),
            value.at("focal_change").number()};
}

}  // namespace

Json json_of(const CameraModel& d, const std::string& serial) {
    Json json{{"width", d.width},
              {"height", d.height},
              {"focal_x", d.focal_x},
              {"focal_y", d.focal_y},
              {"centre_x", d.centre_x},
              {"centre_y", d.centre_y},
              {"k1", d.k1},
              {"k2", d.k2},
              {"p1", d.p1},
              {"p2", d.p2},
              {"k3", d.k3},
              {"device_from_rig", to_json(d.device_from_rig)}};
    if (!serial.empty()) json["serial"] = serial;
    return json;
}

std::string serial_of(const JsonValue& value) {
    const auto serial = value.find("serial");
    return serial ? serial->text() : std::string();
}

CameraModel camera_model_of(const JsonValue& value) {
    value.has_only({"width", "height", "focal_x", "focal_y", "centre_x", "centre_y", "k1", "k2", "p1", "p2", "k3",
                    "device_from_rig", "serial"});
    CameraModel d;
    d.width = static_cast<int>(value.at("width").integer(1, 65535));
    d.height = static_cast<int>(value.at("height").integer(1, 65535));
    d.focal_x = value.at("focal_x").number();
    d.focal_y = value.at("focal_y").number();
    d.centre_x = value.at("centre_x").number(-1e6, 1e6);
    d.centre_y = value.at("centre_y").number(-1e6, 1e6);
    d.k1 = value.at("k1").number();
    d.k2 = value.at("k2").number();
    d.p1 = value.at("p1").number();
    d.p2 = value.at("p2").number();
    d.k3 = value.at("k3").number();
    d.device_from_rig = value.at("device_from_rig").transform();
    return d;
}

Json json_of(const RigName& name) {
    Json json{{"hash", name.hash}, {"made_on", name.made_on}};
    for (const auto& [key, serial] : kSerials)
        if (!(name.serials.*serial).empty()) json[key] = name.serials.*serial;
    return json;
}

RigName rig_name_of(const JsonValue& value) {
    RigName name;
    name.hash = value.at("hash").text();
    name.made_on = value.at("made_on").text();
    for (const auto& [key, serial] : kSerials)
        if (const auto given = value.find(key)) name.serials.*serial = given->text();
    return name;
}

Json json_of(const RigState& state) {
    Json rig, devices, doubts = Json::array();
    for (std::size_t d = 0; d < kRigDevices; ++d) {
        const auto device = static_cast<RigDevice>(d);
        if (present(device_of(state.rig, device))) rig[kKeys[d]] = json_of(device_of(state.rig, device));
        devices[kKeys[d]] = json_of(state.devices[d]);
    }
    for (const RigDoubt& doubt : state.doubts) doubts.push_back(json_of(doubt));
    return {{"verdict", text_of(state.verdict)},
            {"sentence", state.sentence},
            {"remedy", state.remedy},
            {"hidden_light_mm", state.hidden_light_mm},
            {"accepted_movement_mm", state.accepted_movement_mm},
            {"calibrated", json_of(state.calibrated)},
            {"capture_hash", state.capture_hash},
            {"rig", rig},
            {"devices", devices},
            {"doubts", doubts}};
}

RigState rig_state_of(const JsonValue& value) {
    RigState state;
    state.verdict = verdict_of(value.at("verdict"));
    state.sentence = value.at("sentence").text();
    state.remedy = value.at("remedy").text();
    state.hidden_light_mm = value.at("hidden_light_mm").number();
    if (const auto moved = value.find("accepted_movement_mm")) state.accepted_movement_mm = moved->number();
    state.calibrated = rig_name_of(value.at("calibrated"));
    state.capture_hash = value.at("capture_hash").text();
    state.rig.made_on = state.calibrated.made_on;
    state.rig.serials = state.calibrated.serials;
    const JsonValue rig = value.at("rig"), devices = value.at("devices"), doubts = value.at("doubts");
    for (std::size_t d = 0; d < kRigDevices; ++d) {
        const auto device = static_cast<RigDevice>(d);
        if (const auto model = rig.find(kKeys[d])) device_of(state.rig, device) = camera_model_of(*model);
        state.devices[d] = finding_of(devices.at(kKeys[d]));
    }
    for (std::size_t i = 0; i < doubts.size(); ++i) state.doubts.push_back(doubt_of(doubts[i]));
    return state;
}

}  // namespace planlight
