#include "registration/devices/mono_pixels.h"

#include <gtest/gtest.h>

#include <vector>

namespace planlight {
namespace {

/// The same three pixels, 0x12, 0xAB and 0xF0 in their upper eight bits, as each format packs them.
TEST(MonoPixels, EveryFormatHasTheSameUpperBits) {
    const std::vector<std::pair<std::uint32_t, std::vector<std::uint8_t>>> formats{
        {0x01080001, {0x12, 0xAB, 0xF0}},                    // Mono8
        {0x01100003, {0x4B, 0x00, 0xAE, 0x02, 0xC1, 0x03}},  // Mono10: 0x04B, 0x2AE, 0x3C1
        {0x01100005, {0x2C, 0x01, 0xB7, 0x0A, 0x01, 0x0F}},  // Mono12: 0x12C, 0xAB7, 0xF01
        {0x01100007, {0x99, 0x12, 0x01, 0xAB, 0xFF, 0xF0}},  // Mono16
        {0x010C0006, {0x12, 0x7C, 0xAB, 0xF0, 0x01}},        // Mono12Packed
        {0x010C0004, {0x12, 0x23, 0xAB, 0xF0, 0x01}},        // Mono10Packed
        {0x010C0047, {0x2C, 0x71, 0xAB, 0x01, 0x0F}},        // Mono12p
        {0x010A0046, {0x4B, 0xB8, 0x1A, 0x3C}},              // Mono10p: 0x04B, 0x2AE, 0x3C1
    };
    for (const auto& [format, bytes] : formats) {
        const auto picture = mono_picture(bytes, 3, 1, format);
        ASSERT_TRUE(picture) << std::hex << format;
        EXPECT_EQ(picture->at(0, 0), 0x12) << std::hex << format;
        EXPECT_EQ(picture->at(1, 0), 0xAB) << std::hex << format;
        EXPECT_EQ(picture->at(2, 0), 0xF0) << std::hex << format;
        EXPECT_FALSE(mono_picture(bytes, 300, 1, format)) << "too few bytes";
        std::vector<std::uint8_t> two_lines = bytes;
        two_lines.insert(two_lines.end(), 3, 0xEE);
        two_lines.insert(two_lines.end(), bytes.begin(), bytes.end());
        const auto padded = mono_picture(two_lines, 3, 2, format, 3);
        ASSERT_TRUE(padded) << std::hex << format;
        for (const int y : {0, 1}) {
            EXPECT_EQ(padded->at(0, y), 0x12) << std::hex << format;
            EXPECT_EQ(padded->at(2, y), 0xF0) << std::hex << format;
        }
        EXPECT_FALSE(mono_picture(two_lines, 3, 3, format, 3)) << "too few lines";
    }
    EXPECT_FALSE(mono_picture(formats[0].second, 1, 1, 0x02180014)) << "RGB8";
    for (const auto& [format, bytes] : formats)
        EXPECT_FALSE(mono_picture(bytes, 2'000'000'000, 2'000'000'000, format)) << "and no memory is asked for";
}

}  // namespace
}  // namespace planlight
