#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace planlight {

/// What a display says of itself.
struct Edid {
    std::string manufacturer;  ///< three letters (PNP ID)
    std::string name;          ///< the model; may be empty
    std::string serial;        ///< the text serial, else the number, else empty: many projectors give none
};

/// The first block of an EDID (VESA E-EDID 1.3, 128 bytes). Empty when it is too short, without its header, or its
/// checksum is wrong.
std::optional<Edid> parse_edid(const std::vector<std::uint8_t>& bytes);

/// The EDID of an X11 output by its RandR name. Empty without X11, without such an output, or when it tells none.
std::optional<Edid> edid_of_output(const std::string& name);

}  // namespace planlight
