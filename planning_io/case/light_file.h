#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/light_order.h"

namespace planlight {

/// The light.json of a light folder (format in the room's README): what the projector was told, and when the cameras
/// looked. The pictures lie beside it, left/NAME and right/NAME.
struct LightFile {
    Instant settle = std::chrono::milliseconds(250);  ///< after an order, before its light is taken as steady
    std::vector<LightOrder> orders;                   ///< in their order of time
    struct Frame {
        std::string picture;  ///< NNNNNN.png
        std::uint64_t number = 0;
        Instant at{}, exposure{};  ///< mid-exposure; how long the shutter was open
    };
    std::vector<Frame> frames;  ///< in their order of time
};

/// light.json in `folder`; the pictures that it names are there already. Throws DiskError.
void write_light_file(const LightFile& light, const std::filesystem::path& folder);

/// Throws InputError (no orders or frames, times that run backwards, a colour out of range) and DamagedFileError.
LightFile read_light_file(const std::filesystem::path& folder);

/// What `planlight projector` found of a projector, as far as others use it.
struct ProjectorFacts {
    std::string made_on;                 ///< ISO 8601
    int width = 0, height = 0;           ///< its picture
    std::string monitor, serial;         ///< empty: not known
    std::optional<Instant> light_delay;  ///< from the return of `show` to light; empty: not measured
};

/// projector.json. Throws InputError and DamagedFileError.
ProjectorFacts read_projector_file(const std::filesystem::path& file);

}  // namespace planlight
