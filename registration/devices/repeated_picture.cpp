#include "registration/devices/repeated_picture.h"

#include <algorithm>
#include <cstring>

namespace planlight {
namespace {

constexpr int kEveryRow = 8;

/// Of every eighth row and the size; nothing for a picture of one grey. (FNV-1a by words of eight bytes.)
std::optional<std::uint64_t> fingerprint(const GrayImage& picture) {
    if (picture.empty()) return std::nullopt;
    const auto mixed = [](std::uint64_t sum, std::uint64_t word) {
        sum = (sum ^ word) * 0x100000001b3ull;
        return sum ^ (sum >> 29);
    };
    const auto columns = static_cast<std::size_t>(picture.width);
    const std::uint8_t grey = picture.pixels[0];
    bool one_grey = true;
    std::uint64_t sum = mixed(0xcbf29ce484222325ull, columns);
    for (int y = 0; y < picture.height; y += kEveryRow) {
        const std::uint8_t* row = &picture.pixels[picture.index(0, y)];
        one_grey = one_grey && std::all_of(row, row + columns, [&](std::uint8_t value) { return value == grey; });
        for (std::size_t x = 0; x < columns; x += sizeof(std::uint64_t)) {
            std::uint64_t word = 0;
            std::memcpy(&word, row + x, std::min(sizeof word, columns - x));
            sum = mixed(sum, word);
        }
    }
    if (one_grey) return std::nullopt;
    return sum;
}

}  // namespace

bool RepeatedPicture::is(const GrayImage& picture) {
    const std::optional<std::uint64_t> now = fingerprint(picture);
    const bool repeated = now && now == last_;
    last_ = now;
    return repeated;
}

}  // namespace planlight
