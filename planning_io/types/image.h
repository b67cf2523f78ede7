#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "planning_io/types/large_array.h"

namespace planlight {

/// 8-bit grey picture, rows from the top, no padding.
struct GrayImage {
    int width = 0, height = 0;
    LargeArray<std::uint8_t> pixels;  ///< height x width

    GrayImage() = default;
    GrayImage(int w, int h, std::uint8_t value = 0)
        : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), value) {}
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }
    std::uint8_t at(int x, int y) const { return pixels[index(x, y)]; }
    std::uint8_t& at(int x, int y) { return pixels[index(x, y)]; }
    bool empty() const { return pixels.empty(); }
};

using Rgb = std::array<std::uint8_t, 3>;

/// 8-bit RGB picture, rows from the top, no padding.
struct RgbImage {
    int width = 0, height = 0;
    LargeArray<Rgb> pixels;  ///< height x width

    RgbImage() = default;
    RgbImage(int w, int h, Rgb value = {0, 0, 0})
        : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {
        fill(value);
    }
    void fill(Rgb value) {
        if (value[0] == value[1] && value[1] == value[2])  // three bytes at a time cost ten times as much
            std::fill_n(reinterpret_cast<std::uint8_t*>(pixels.data()), 3 * pixels.size(), value[0]);
        else
            std::fill(pixels.begin(), pixels.end(), value);
    }
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }
    const Rgb& at(int x, int y) const { return pixels[index(x, y)]; }
    Rgb& at(int x, int y) { return pixels[index(x, y)]; }
    bool empty() const { return pixels.empty(); }
};

}  // namespace planlight
