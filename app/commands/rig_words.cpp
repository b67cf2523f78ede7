#include "app/commands/rig_words.h"

#include <array>
#include <nlohmann/json.hpp>
#include <numbers>

namespace planlight {
namespace {

constexpr std::array kKeys{"left_camera", "right_camera", "projector"};  // by RigDevice

const char* words_of(const RigState& state, const DeviceFinding& device) {
    if (state.verdict == RigState::Verdict::unknown) return "not known";
    if (device.moved) return device.lens ? "lens changed" : "moved";
    return device.maybe ? "perhaps moved" : "as calibrated";
}

}  // namespace

nlohmann::ordered_json rig_state_json(const RigState& state) {
    nlohmann::ordered_json devices;
    const bool known = state.verdict != RigState::Verdict::unknown;
    const auto or_null = [&](double value) { return known ? nlohmann::ordered_json(value) : nullptr; };
    for (std::size_t d = 0; d < kRigDevices; ++d) {
        const DeviceFinding& device = state.devices[d];
        devices[kKeys[d]] = {{"known", words_of(state, device)},
                             {"moved_mm", or_null(device.moved_mm)},
                             {"turned_deg", or_null(device.turned * 180 / std::numbers::pi)},
                             {"focal_change_percent", or_null(100 * device.focal_change)}};
    }
    return {{"verdict", text_of(state.verdict)},
            {"sentence", state.sentence},
            {"remedy", state.remedy},
            {"hidden_light_mm", or_null(state.hidden_light_mm)},
            {"devices", devices}};
}

}  // namespace planlight
