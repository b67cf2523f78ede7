#include "registration/devices/mono_pixels.h"

#include <cstring>

namespace planlight {
namespace {

// Pixel Format Naming Convention 2.4, table of 32-bit values.
constexpr std::uint32_t kMono8 = 0x01080001, kMono10 = 0x01100003, kMono12 = 0x01100005, kMono14 = 0x01100025,
                        kMono16 = 0x01100007, kMono10Packed = 0x010C0004, kMono12Packed = 0x010C0006,
                        kMono10p = 0x010A0046, kMono12p = 0x010C0047;

/// Bytes that so many pixels take; empty for what is no grey picture.
std::optional<std::size_t> bytes_of(std::size_t pixels, std::uint32_t format) {
    switch (format) {
        case kMono8:
            return pixels;
        case kMono10:
        case kMono12:
        case kMono14:
        case kMono16:
            return 2 * pixels;
        case kMono10Packed:
        case kMono12Packed:  // two pixels in three bytes; a last one alone has two
            return pixels / 2 * 3 + pixels % 2 * 2;
        case kMono10p:
            return (pixels * 10 + 7) / 8;
        case kMono12p:
            return (pixels * 12 + 7) / 8;
        default:
            return std::nullopt;
    }
}

int bits_of_two_bytes(std::uint32_t format) {
    switch (format) {
        case kMono10:
            return 10;
        case kMono12:
            return 12;
        case kMono14:
            return 14;
        case kMono16:
            return 16;
        default:
            return 0;
    }
}

/// Pixels that follow each other without a gap, of a format that `bytes_of` knows.
void take_upper_bits(const std::uint8_t* data, std::size_t pixels, std::uint32_t format, std::uint8_t* out) {
    if (format == kMono8) {
        std::memcpy(out, data, pixels);
    } else if (const int bits = bits_of_two_bytes(format); bits > 0) {
        for (std::size_t i = 0; i < pixels; ++i) {
            const unsigned value = data[2 * i] | static_cast<unsigned>(data[2 * i + 1]) << 8;
            out[i] = static_cast<std::uint8_t>(value >> (bits - 8) & 0xFF);
        }
    } else if (format == kMono10Packed || format == kMono12Packed) {
        // Two pixels in three bytes; the upper eight bits of each have a byte of their own.
        for (std::size_t i = 0; i < pixels; ++i) out[i] = data[i / 2 * 3 + (i % 2) * 2];
    } else {
        const std::size_t each = format == kMono10p ? 10 : 12;  // one after the other, lowest bit first
        for (std::size_t i = 0; i < pixels; ++i) {
            const std::size_t upper = i * each + each - 8, byte = upper / 8, shift = upper % 8;
            unsigned value = data[byte];
            if (shift > 0) value |= static_cast<unsigned>(data[byte + 1]) << 8;
            out[i] = static_cast<std::uint8_t>(value >> shift & 0xFF);
        }
    }
}

}  // namespace

std::optional<GrayImage> mono_picture(std::span<const std::uint8_t> data, int width, int height,
                                      std::uint32_t pixel_format, int line_padding) {
    if (width <= 0 || height <= 0 || line_padding < 0) return std::nullopt;
    // With padding each line begins with a byte; without, a packed one may begin within the last of the line before.
    const auto lines = static_cast<std::size_t>(line_padding > 0 ? height : 1);
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) / lines;
    const auto bytes = bytes_of(pixels, pixel_format);
    if (!bytes) return std::nullopt;
    const std::size_t stride = *bytes + static_cast<std::size_t>(line_padding);
    // Before any memory is taken: a camera's header can say anything.
    if (data.size() < (lines - 1) * stride + *bytes) return std::nullopt;
    GrayImage picture(width, height);
    for (std::size_t line = 0; line < lines; ++line)
        take_upper_bits(data.data() + line * stride, pixels, pixel_format, picture.pixels.data() + line * pixels);
    return picture;
}

}  // namespace planlight
