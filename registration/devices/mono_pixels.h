#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "planning_io/types/image.h"

namespace planlight {

/// A grey picture as a camera sends it (GigE Vision and PFNC pixel formats Mono8, Mono10, Mono12, Mono14, Mono16, and
/// the packed ones of 10 and 12 bits, both GigE's and PFNC's), as its upper 8 bits. Behind each line stand
/// `line_padding` bytes that are no picture (GigE Vision's padding_x). Empty for other formats and for data that is too
/// short.
std::optional<GrayImage> mono_picture(std::span<const std::uint8_t> data, int width, int height,
                                      std::uint32_t pixel_format, int line_padding = 0);

}  // namespace planlight
