#include "registration/scan/gray_code.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <stdexcept>

namespace planlight {
namespace {

constexpr int kLeastDifference_grey = 5;
constexpr double kLeastShare = 0.15;  ///< of (white - black)

int bits_for(int size) {
    int bits = 1;
    while ((1 << bits) < size) ++bits;
    return bits;
}

int number_of(int gray) {
    for (int shift = 1; shift < 32; shift *= 2) gray ^= gray >> shift;
    return gray;
}

/// The projector pixel behind a Gray code; a pixel at the border of two has one bit in doubt and lies between them. -1 where
/// more is in doubt, a bit away from its own border, or the number is not on the panel.
float decode_pixel(std::span<const GrayImage> pairs, int bits, std::size_t pixel, double least, int size) {
    int gray = 0, doubt = 0;
    for (int b = 0; b < bits; ++b) {
        const auto i = static_cast<std::size_t>(2 * b);
        const int difference = pairs[i].pixels[pixel] - pairs[i + 1].pixels[pixel], bit = 1 << (bits - 1 - b);
        if (difference > 0) gray |= bit;
        if (std::abs(difference) < least) {
            if (doubt) return -1;
            doubt = bit;
        }
    }
    const int number = number_of(gray), other = doubt ? number_of(gray ^ doubt) : number;
    if (number >= size || other >= size || std::abs(number - other) > 1) return -1;
    return static_cast<float>(number + other) / 2;
}

}  // namespace

std::vector<std::string> gray_code_names(int projector_width, int projector_height) {
    std::vector<std::string> names{"white", "black"};
    for (const auto& [direction, size] : {std::pair{"column", projector_width}, std::pair{"row", projector_height}})
        for (int bit = 0; bit < bits_for(size); ++bit) {
            names.push_back(fmt::format("{}-gray-{}", direction, bit));
            names.push_back(fmt::format("{}-gray-{}-inverse", direction, bit));
        }
    return names;
}

DecodedView decode_gray_code(std::span<const GrayImage> frames, int projector_width, int projector_height) {
    const int column_bits = bits_for(projector_width), row_bits = bits_for(projector_height);
    if (frames.size() != static_cast<std::size_t>(2 + 2 * column_bits + 2 * row_bits))
        throw std::invalid_argument(
            fmt::format("decode_gray_code: {} frames, {} are needed", frames.size(), 2 + 2 * column_bits + 2 * row_bits));
    const std::size_t count = frames[0].pixels.size();
    for (const GrayImage& frame : frames)
        if (frame.width != frames[0].width || frame.pixels.size() != count)
            throw std::invalid_argument("decode_gray_code: frames of different size");
    DecodedView view;
    view.width = frames[0].width;
    view.height = frames[0].height;
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    view.column.assign(count, kNaN);
    view.row.assign(count, kNaN);
    view.sigma_px.assign(count, kNaN);
    const auto column_pairs = frames.subspan(2), row_pairs = frames.subspan(static_cast<std::size_t>(2 + 2 * column_bits));
    for (std::size_t i = 0; i < count; ++i) {
        const int white = frames[0].pixels[i], contrast = white - frames[1].pixels[i];
        if (white >= 254) {
            ++view.saturated;
            continue;
        }
        if (contrast < kLeastDifference_grey) {
            ++view.dark;
            continue;
        }
        const double least = std::max<double>(kLeastDifference_grey, kLeastShare * contrast);
        const float column = decode_pixel(column_pairs, column_bits, i, least, projector_width);
        const float row = decode_pixel(row_pairs, row_bits, i, least, projector_height);
        if (column < 0 || row < 0) {
            ++view.uncertain;
            continue;
        }
        ++view.decoded;
        view.column[i] = column;
        view.row[i] = row;
        view.sigma_px[i] = 0.29F;  // of an even spread over one pixel
    }
    return view;
}

}  // namespace planlight
