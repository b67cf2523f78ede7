#include "planning_io/types/utf8_prefix.h"

#include <gtest/gtest.h>

#include <string>

namespace planlight::test {
namespace {

TEST(Utf8Prefix, CutsNoLetterInTwo) {
    const std::string text = "Kopf \xC3\xBC\xE2\x82\xAC";  // two bytes, then three
    EXPECT_EQ(utf8_prefix(text, 4), "Kopf");
    EXPECT_EQ(utf8_prefix(text, 6), "Kopf ");
    EXPECT_EQ(utf8_prefix(text, 7), "Kopf \xC3\xBC");
    EXPECT_EQ(utf8_prefix(text, 9), "Kopf \xC3\xBC");
    EXPECT_EQ(utf8_prefix(text, 10), text);
    EXPECT_EQ(utf8_prefix(text, 100), text);
    EXPECT_EQ(utf8_prefix(text, 0), "");
    EXPECT_EQ(utf8_prefix("\x80\x80\x80", 2), "") << "no beginning of a letter";
}

}  // namespace
}  // namespace planlight::test
