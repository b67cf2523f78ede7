#include "registration/devices/genicam_automatics.h"

#include <fmt/format.h>

#include <cmath>

#include "registration/devices/genicam_failure.h"

namespace planlight {
namespace {

class Features {
public:
    explicit Features(ArvCamera* camera) : camera_(camera) {}

    bool has(const char* name) {
        return arv_camera_is_feature_available(camera_, name, failure_.slot()) && !failure_.happened();
    }
    /// Of a name that it has.
    bool is_on(const char* name) {
        const bool on = arv_camera_get_boolean(camera_, name, failure_.slot());
        return on && !failure_.happened();
    }
    std::string value(const char* name) {
        const char* const text = arv_camera_get_string(camera_, name, failure_.slot());
        return text && !failure_.happened() ? text : "";
    }
    void choose(const char* name, const char* value) { arv_camera_set_string(camera_, name, value, failure_.slot()); }
    void switch_off(const char* name) { arv_camera_set_boolean(camera_, name, false, failure_.slot()); }

private:
    ArvCamera* camera_;
    GenicamFailure failure_;
};

void switch_off_switches(Features& features, std::vector<std::string>& notes) {
    for (const char* name : {"GammaEnable", "GammaEnabled", "SharpnessEnable", "SharpnessEnabled", "LUTEnable",
                             "ContrastEnable", "NoiseReductionEnable", "HDREnable"}) {
        if (!features.has(name)) continue;
        features.switch_off(name);
        if (features.is_on(name)) notes.push_back(fmt::format("{} cannot be switched off", name));
    }
    for (const char* name : {"BlackLevelAuto", "BalanceWhiteAuto", "TestPattern", "TestImageSelector"}) {
        if (!features.has(name) || features.value(name) == "Off") continue;
        features.choose(name, "Off");
        if (const std::string now = features.value(name); !now.empty() && now != "Off")
            notes.push_back(fmt::format("its {} stays at {}", name, now));
    }
}

void set_gamma(ArvCamera* camera, std::vector<std::string>& notes) {
    GenicamFailure failure;
    if (!arv_camera_is_feature_available(camera, "Gamma", failure.slot())) return;
    arv_camera_set_float(camera, "Gamma", 1, failure.slot());
    const double gamma = arv_camera_get_float(camera, "Gamma", failure.slot());
    if (!failure.happened() && std::abs(gamma - 1) > 0.01)
        notes.push_back(fmt::format("its gamma stays at {:.2f}", gamma));
}

void switch_off_exposure_and_gain(ArvCamera* camera, std::vector<std::string>& notes) {
    GenicamFailure failure;
    if (arv_camera_is_exposure_auto_available(camera, failure.slot())) {
        arv_camera_set_exposure_time_auto(camera, ARV_AUTO_OFF, failure.slot());
        if (arv_camera_get_exposure_time_auto(camera, failure.slot()) != ARV_AUTO_OFF)
            notes.emplace_back("its automatic exposure cannot be switched off");
    }
    if (arv_camera_is_gain_auto_available(camera, failure.slot())) {
        arv_camera_set_gain_auto(camera, ARV_AUTO_OFF, failure.slot());
        if (arv_camera_get_gain_auto(camera, failure.slot()) != ARV_AUTO_OFF)
            notes.emplace_back("its automatic gain cannot be switched off");
    }
}

constexpr const char* kShutter = "SensorShutterMode";

void choose_shutter(Features& features, std::vector<std::string>& notes) {
    if (!features.has(kShutter)) return;
    if (features.value(kShutter) != "Global") features.choose(kShutter, "Global");
    if (features.value(kShutter) == "Rolling")
        notes.emplace_back("its shutter rolls: a head that moves is seen bent; take one with a global shutter");
}

/// Both together are a picture turned by half a turn, as of a camera that hangs upside down.
void look_for_mirror(Features& features, std::vector<std::string>& notes) {
    const bool x = features.has("ReverseX") && features.is_on("ReverseX"),
               y = features.has("ReverseY") && features.is_on("ReverseY");
    if (x != y)
        notes.push_back(
            fmt::format("its picture is mirrored (Reverse{}): switch that off by its own program", x ? "X" : "Y"));
}

}  // namespace

std::vector<std::string> switch_off_automatics(ArvCamera* camera) {
    std::vector<std::string> notes;
    Features features(camera);
    switch_off_switches(features, notes);
    set_gamma(camera, notes);
    switch_off_exposure_and_gain(camera, notes);
    choose_shutter(features, notes);
    look_for_mirror(features, notes);
    return notes;
}

Shutter shutter_of(ArvCamera* camera) {
    Features features(camera);
    const std::string mode = features.has(kShutter) ? features.value(kShutter) : "";
    return mode.empty() ? Shutter::unknown : mode == "Global" ? Shutter::global : Shutter::other;
}

}  // namespace planlight
