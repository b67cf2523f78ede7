#include <gtest/gtest.h>

#include "planning_io/files/one_line.h"

namespace planlight {
namespace {

TEST(OnOneLine, LeavesTheNamesOfEveryScriptAsTheyAre) {
    for (const char* name : {"", "Left way  in", "Опухоль", "الورم 12", "腫瘍", "Größe 3 µm", "🧠"})
        EXPECT_EQ(on_one_line(name), name);
}

TEST(OnOneLine, MakesOneSpaceOfBreaksAndControls) {
    EXPECT_EQ(on_one_line("ves\r\n\tsel\n"), "ves sel");
    EXPECT_EQ(on_one_line("a\xC2\x85"
                          "b\xE2\x80\xA8"
                          "c\xE2\x80\xA9"
                          "d"),
              "a b c d")
        << "U+0085, U+2028, U+2029";
    EXPECT_EQ(on_one_line("evil\n\x1B[31mred\x7F"), "evil [31mred");
    EXPECT_EQ(on_one_line("a\xC2\x9B"
                          "31m"),
              "a 31m")
        << "U+009B begins an order to a terminal";
}

TEST(OnOneLine, LeavesOutWhatTurnsTheDirection) {
    for (const char* order :
         {"\xE2\x80\xAA", "\xE2\x80\xAB", "\xE2\x80\xAC", "\xE2\x80\xAD", "\xE2\x80\xAE", "\xE2\x81\xA6",
          "\xE2\x81\xA7", "\xE2\x81\xA8", "\xE2\x81\xA9", "\xE2\x80\x8E", "\xE2\x80\x8F", "\xD8\x9C"})
        EXPECT_EQ(on_one_line(std::string("sel") + order + "12"), "sel12");
}

TEST(OnOneLine, TakesBytesThatAreNoText) {
    EXPECT_EQ(on_one_line("caf\xE9"), "caf\xE9") << "Latin-1";
    EXPECT_EQ(on_one_line("a\x9B"
                          "b\x85"),
              "a b")
        << "a terminal of 8 bits takes the first for an order";
    EXPECT_EQ(on_one_line("cut \xE2\x80"), "cut \xE2");
}

}  // namespace
}  // namespace planlight
