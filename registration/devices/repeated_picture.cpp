#include "registration/devices/repeated_picture.h"

#include <algorithm>
#include <cstring>

namespace planlight {
namespace {

/// Of all pixels and the size; nothing where hardly a pixel is another grey than the rest. (FNV-1a by words of eight
/// bytes.)
std::optional<std::uint64_t> fingerprint(const GrayImage& picture) {
    if (picture.empty()) return std::nullopt;
    const auto mixed = [](std::uint64_t sum, std::uint64_t word) {
        sum = (sum ^ word) * 0x100000001b3ull;
        return sum ^ (sum >> 29);
    };
    constexpr std::size_t kHardlyAny = 1000;  // one of so many
    const std::size_t size = picture.pixels.size();
    const std::uint8_t* pixels = picture.pixels.data();
    const auto same = static_cast<std::size_t>(std::count(pixels, pixels + size, pixels[size / 2]));
    if ((size - same) * kHardlyAny <= size) return std::nullopt;
    std::uint64_t sum = mixed(0xcbf29ce484222325ull, static_cast<std::uint64_t>(picture.width));
    for (std::size_t i = 0; i < size; i += sizeof(std::uint64_t)) {
        std::uint64_t word = 0;
        std::memcpy(&word, pixels + i, std::min(sizeof word, size - i));
        sum = mixed(sum, word);
    }
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
