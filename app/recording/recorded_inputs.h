#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "planning_io/types/time.h"

namespace planlight {

/// One answer of a session's devices, as a recording keeps it.
struct RecordedInput {
    enum class Kind : std::uint8_t {
        clock = 1,    ///< it was `at`
        shown = 2,    ///< a picture of that hash until `until`; it is light from `at` on
        dark = 3,     ///< the projector was told to be dark
        frame = 4,    ///< exposed about `at` for `until`, with that number; its pictures have that hash
        failed = 5,   ///< a device threw `text`, with `remedy`
        stopped = 6,  ///< whoever asked ended the scan, saying `text`, `remedy`
        doubt = 7,    ///< the cameras say of themselves `text`; empty: nothing any more
        exposed = 8   ///< the next frame's shutters have closed
    };
    Kind kind = Kind::clock;
    Instant at{}, until{};
    std::uint64_t number = 0;
    std::string text, remedy;  ///< of pictures `text` is their hash
};

/// The payload of an INPT chunk.
std::string packed(const std::vector<RecordedInput>& inputs);

/// Throws DamagedFileError (`file`: for its words).
std::vector<RecordedInput> unpacked_inputs(std::string_view payload, const std::filesystem::path& file);

}  // namespace planlight
