#include "projection/monitor/edid.h"

#include <gtest/gtest.h>

#include <numeric>

#include "projection/monitor/monitor_card.h"

namespace planlight {
namespace {

/// A block as a projector would give it: PNP ID "EPS", number 0x00C0FFEE, name and text serial where wanted.
std::vector<std::uint8_t> block(const std::string& name, const std::string& serial) {
    std::vector<std::uint8_t> bytes(128, 0);
    for (std::size_t i = 1; i < 7; ++i) bytes[i] = 0xFF;
    const unsigned letters = ('E' - 64U) << 10U | ('P' - 64U) << 5U | ('S' - 64U);
    bytes[8] = static_cast<std::uint8_t>(letters >> 8U);
    bytes[9] = static_cast<std::uint8_t>(letters);
    bytes[12] = 0xEE, bytes[13] = 0xFF, bytes[14] = 0xC0;
    bytes[54] = 0x02;  // a timing, no text
    const auto text = [&](std::size_t at, std::uint8_t tag, const std::string& words) {
        bytes[at + 3] = tag;
        for (std::size_t i = 0; i < 13; ++i)
            bytes[at + 5 + i] = static_cast<std::uint8_t>(i < words.size() ? words[i] : i == words.size() ? '\n' : ' ');
    };
    if (!name.empty()) text(72, 0xFC, name);
    if (!serial.empty()) text(90, 0xFF, serial);
    bytes[127] = static_cast<std::uint8_t>(256 - std::accumulate(bytes.begin(), bytes.end(), 0U) % 256);
    return bytes;
}

TEST(Edid, GivesMakerModelAndSerial) {
    const auto edid = parse_edid(block("EPSON PJ", "X7K2-0041"));
    ASSERT_TRUE(edid);
    EXPECT_EQ(edid->manufacturer, "EPS");
    EXPECT_EQ(edid->name, "EPSON PJ");
    EXPECT_EQ(edid->serial, "X7K2-0041");
}

TEST(Edid, TheNumberStandsInForAMissingTextAndFillersForNothing) {
    EXPECT_EQ(parse_edid(block("PJ", ""))->serial, std::to_string(0x00C0FFEE));
    auto bytes = block("PJ", "");
    for (std::size_t i = 12; i < 16; ++i) bytes[i] = 1;
    bytes[127] = 0;
    bytes[127] = static_cast<std::uint8_t>(256 - std::accumulate(bytes.begin(), bytes.end(), 0U) % 256);
    EXPECT_EQ(parse_edid(bytes)->serial, "");
}

TEST(Edid, DamagedBytesAreNoEdid) {
    const auto good = block("EPSON PJ", "X7K2");
    EXPECT_FALSE(parse_edid({}));
    EXPECT_FALSE(parse_edid({good.begin(), good.end() - 1}));
    for (std::size_t i = 0; i < 128; ++i) {
        auto bad = good;
        bad[i] ^= 0x10;
        EXPECT_FALSE(parse_edid(bad)) << i;
    }
}

TEST(MonitorCard, IsThinLightOnBlackAndAnotherForEveryMonitor) {
    Monitor monitor{"HDMI-2", 0, 0, 1280, 800, false, 60, "EPSON PJ", "X7K2"};
    const RgbImage card = draw_monitor_card(monitor, 1);
    ASSERT_EQ(card.width, 1280);
    ASSERT_EQ(card.height, 800);
    long lit = 0;
    bool at_the_edge = false;
    for (int y = 0; y < card.height; ++y)
        for (int x = 0; x < card.width; ++x) {
            const bool here = card.at(x, y)[0] > 40;
            lit += here;
            at_the_edge = at_the_edge || (here && (x < 8 || y < 8 || x >= 1272 || y >= 792));
        }
    EXPECT_GT(lit, 1280 * 800 / 100);
    EXPECT_LT(lit, 1280 * 800 / 8) << "most of it is dark";
    EXPECT_FALSE(at_the_edge) << "overscan would cut the name";
    monitor.name = "HDMI-1";
    EXPECT_NE(draw_monitor_card(monitor, 1).pixels, card.pixels);
    monitor.name = "a very long name that some driver came up with, on a small picture";
    monitor.width = 320, monitor.height = 240;
    const RgbImage small = draw_monitor_card(monitor, 12);
    for (int y = 0; y < 240; ++y) EXPECT_EQ(small.at(1, y)[0], 0) << "nothing runs out of the picture";
}

}  // namespace
}  // namespace planlight
