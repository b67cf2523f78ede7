#include "app/words/words.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "app/words/word_pattern.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

TEST(WordPattern, PutsFiguresIntoTheirPlacesInAnyOrder) {
    const WordPattern english("only {n} of {n2} markers seen"), own("von {n2} Markern nur {n}");
    const auto values = english.match("only 3 of 6 markers seen", [](const auto&) { return true; });
    ASSERT_TRUE(values);
    EXPECT_EQ(own.filled(*values), "von 6 Markern nur 3");
    EXPECT_FALSE(english.match("only some of 6 markers seen", [](const auto&) { return true; })) << "no number";
    EXPECT_FALSE(english.match("only 3 of 6 markers seen today", [](const auto&) { return true; }));
}

TEST(WordPattern, TakesEveryNumberAsItIsWritten) {
    const WordPattern pattern("{mm} mm");
    for (const char* number : {"0", "12", "-0.5", "+1.25", "inf", "-inf", "nan"}) {
        const auto values = pattern.match(std::string(number) + " mm", [](const auto&) { return true; });
        ASSERT_TRUE(values) << number;
        EXPECT_EQ(values->at("mm"), number);
    }
    EXPECT_FALSE(pattern.match("1,5 mm", [](const auto&) { return true; }));
}

TEST(WordPattern, ABracketWithoutPartnerIsRefused) {
    for (const char* text : {"a {mm", "a mm}", "{}", "{a{b}}"}) EXPECT_THROW(WordPattern{text}, std::invalid_argument);
}

Words german_for_tests() {
    return Words({"xx",
                  "Test",
                  {{"Scan", "Aufnahme"},
                   {"Dark: {words}.", "Dunkel: {words}."},
                   {"only {n} of {n2} markers seen", "nur {n} von {n2} Markern"},
                   {"LOOK: \"{name}\" is not measured.", "PRÜFEN: „{name}“ ungemessen."},
                   {"ärmel", "übung"},
                   {"scan again", "über Nacht warten"}}});
}

TEST(Words, ANameStaysAsItIsAndASentenceInASentenceIsTranslated) {
    const Words words = german_for_tests();
    EXPECT_EQ(words.say("Dark: only 3 of 6 markers seen."), "Dunkel: nur 3 von 6 Markern.");
    EXPECT_EQ(words.say("LOOK: \"Scan\" is not measured."), "PRÜFEN: „Scan“ ungemessen.") << "an item may be called so";
    EXPECT_EQ(words.say("Scan again."), "Über Nacht warten.") << "its capital and its full stop";
}

TEST(Words, WhatIsNotTranslatedIsShownInEnglishNeverBlank) {
    const Words words = german_for_tests();
    EXPECT_EQ(words.say("Nobody translated this."), "Nobody translated this.");
    EXPECT_EQ(words.say("Dark: nobody translated this."), "Dunkel: nobody translated this.");
    EXPECT_EQ(words.say("Scan. Nobody translated this."), "Aufnahme. Nobody translated this.");
    EXPECT_FALSE(words.knows("Dark: nobody translated this."));
    EXPECT_EQ(words.say(""), "");
    EXPECT_EQ(Words().say("Dark: x."), "Dark: x.") << "English is as it is";
}

TEST(Words, ALanguageThatNobodyTranslatedIsRefusedWithThoseThereAre) {
    try {
        words_of("tlh");
        FAIL();
    } catch (const InputError& refused) {
        EXPECT_NE(refused.remedy.find("de, en, ru"), std::string::npos) << refused.remedy;
    }
    EXPECT_THROW(words_of("../../etc/passwd"), InputError);
}

TEST(LanguageFile, OtherPlacesThanTheEnglishAreRefused) {
    const auto file = [](const std::string& own) {
        return R"({"format": "planlight words", "version": 1, "language": "xx", "name": "X", "words": {"A": {"{mm} mm": ")" +
               own + "\"}}}";
    };
    EXPECT_EQ(read_language(file("{mm} Millimeter"), "xx.json").words.size(), 1U);
    for (const char* wrong : {"Millimeter", "{cm} mm", "{mm} {mm} mm", "{mm"})
        EXPECT_THROW(read_language(file(wrong), "xx.json"), InputError) << wrong;
    EXPECT_THROW(read_language("{", "xx.json"), DamagedFileError);
}

}  // namespace
}  // namespace planlight
