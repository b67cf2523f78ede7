#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <string>

#include "planning_io/case/room_file.h"
#include "planning_io/types/error.h"
#include "registration/tracking/find_markers.h"

namespace planlight {

/// "8/16": diameters of disc and sticker, mm. Throws InputError.
inline MarkerDesign marker_design_named(const std::string& text) {
    MarkerDesign design;
    const char *at = text.data(), *const end = text.data() + text.size();
    const auto disc = std::from_chars(at, end, design.disc_diameter_mm);
    at = disc.ptr;
    const bool parted = disc.ec == std::errc() && at != end && *at++ == '/';
    const auto sticker = std::from_chars(at, end, design.sticker_diameter_mm);
    const bool told = parted && sticker.ec == std::errc() && sticker.ptr == end;
    if (!told || !may_be_pasted(design.disc_diameter_mm, design.sticker_diameter_mm))
        throw InputError({}, fmt::format("\"{}\" is no size of markers", text),
                         "Say the diameters of the black disc and of its white sticker in mm, as 8/16.");
    return design;
}

inline CLI::Option* markers_option(CLI::App* sub, std::string& markers) {
    return sub->add_option("--markers", markers, "Diameters of the markers' discs and stickers, mm (default: 8/16)");
}

}  // namespace planlight
