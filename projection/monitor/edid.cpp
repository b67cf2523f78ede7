#include "projection/monitor/edid.h"

#include <array>
#include <numeric>

namespace planlight {
namespace {

constexpr std::size_t kBlock = 128;
constexpr std::array<std::uint8_t, 8> kHeader{0, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0};
constexpr std::uint8_t kSerialText = 0xFF, kName = 0xFC;

/// Text of a descriptor: up to 13 signs, ended by a line feed; what is not printable is left out.
std::string text_at(const std::vector<std::uint8_t>& bytes, std::size_t from) {
    std::string text;
    for (std::size_t i = from; i < from + 13 && bytes[i] != '\n' && bytes[i] != 0; ++i)
        if (bytes[i] >= 0x20 && bytes[i] < 0x7F) text += static_cast<char>(bytes[i]);
    while (!text.empty() && text.back() == ' ') text.pop_back();
    return text;
}

}  // namespace

std::optional<Edid> parse_edid(const std::vector<std::uint8_t>& bytes) {
    if (bytes.size() < kBlock) return std::nullopt;
    for (std::size_t i = 0; i < kHeader.size(); ++i)
        if (bytes[i] != kHeader[i]) return std::nullopt;
    if (std::accumulate(bytes.begin(), bytes.begin() + kBlock, 0U) % 256 != 0) return std::nullopt;
    Edid edid;
    const unsigned letters = bytes[8] * 256U + bytes[9];  // five bits each, A = 1
    for (const unsigned shift : {10U, 5U, 0U})
        edid.manufacturer += static_cast<char>('A' + static_cast<int>(letters >> shift & 31U) - 1);
    for (std::size_t at = 54; at + 18 <= 126; at += 18) {
        if (bytes[at] != 0 || bytes[at + 1] != 0 || bytes[at + 2] != 0) continue;  // a picture's timing
        if (bytes[at + 3] == kName) edid.name = text_at(bytes, at + 5);
        if (bytes[at + 3] == kSerialText) edid.serial = text_at(bytes, at + 5);
    }
    const std::uint32_t number =
        bytes[12] | bytes[13] << 8U | bytes[14] << 16U | static_cast<std::uint32_t>(bytes[15]) << 24U;
    constexpr std::uint32_t kFiller = 0x01010101;
    if (edid.serial.empty() && number != 0 && number != kFiller) edid.serial = std::to_string(number);
    return edid;
}

}  // namespace planlight
