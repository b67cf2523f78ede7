#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "registration/projector_measurement/light_recording.h"
#include "registration/projector_measurement/record_light.h"
#include "registration/simulation/board_room.h"

namespace planlight {

/// The three measurements, by the names of their folders.
constexpr const char* kLightParts[] = {"latency", "response", "cycle"};

/// A light folder: light.json and its pictures, one at a time in memory. A missing or damaged picture is refused.
LightRecording read_light_folder(const std::filesystem::path& folder);

/// Records one part over the bench, then whatever `afterwards` adds to it; keeps every frame and light.json in `folder`
/// unless that is empty.
LightRecording record_part(const std::string& part, LightBench bench, const RecordSettings& settings,
                           const std::filesystem::path& folder,
                           const std::function<void(const LightBench&, LightRecording&)>& afterwards = {});

/// NAME=VALUE words for the simulated room's light: gamma, black, dark-end, bright-end (greys), wheel-hz, mains-hz,
/// mains (%), delay-ms (untold), jitter-ms, refresh-hz, skipped (%), lost (%), brightness, ambient. Throws InputError.
void set_simulated_light(const std::vector<std::string>& words, simulation::BoardRoomSettings& room);

}  // namespace planlight
