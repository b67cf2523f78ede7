#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "app/commands/language_option.h"
#include "app/words/words.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

/// A site's own settings folder, empty at first.
class SitesWords : public testing::Test {
protected:
    const fs::path folder_ = fs::temp_directory_path() / ("planlight-words-" + std::to_string(getpid()));
    void SetUp() override {
        fs::create_directories(folder_ / "planlight" / "words");
        setenv("XDG_CONFIG_HOME", folder_.c_str(), 1);
    }
    void TearDown() override {
        unsetenv("XDG_CONFIG_HOME");
        fs::remove_all(folder_);
    }
    void write(const std::string& code, const std::string& words) const {
        std::ofstream(folder_ / "planlight" / "words" / (code + ".json"))
            << R"({"format": "planlight words", "version": 1, "language": ")" << code
            << R"(", "name": "X", "words": {"A": )" << words << "}}";
    }
};

TEST_F(SitesWords, AHospitalsOwnFileIsUsedAndMayBeAPart) {
    write("fr", R"({"Scan": "Numérisation"})");
    const auto words = words_of_window("fr", {});
    EXPECT_EQ(words->say("Scan"), "Numérisation");
    EXPECT_EQ(words->say("Stop"), "Stop") << "what it lacks is in English";
    const auto codes = language_codes();
    EXPECT_TRUE(std::find(codes.begin(), codes.end(), "fr") != codes.end());
    write("de", R"({"Scan": "Aufnahme"})");
    EXPECT_EQ(words_of("de")->say("Scan"), "Aufnahme") << "in place of ours";
}

// A patient does not wait for a translation; what a person asked for by name is refused.
TEST_F(SitesWords, AFileThatIsNotRightLeavesTheWindowInEnglish) {
    write("fr", R"({"{n} boreholes": "trous"})");
    SiteSettings site;
    site.language = "fr";
    EXPECT_EQ(words_of_window({}, site)->code(), "en");
    EXPECT_THROW(words_of_window("fr", site), InputError);
    EXPECT_EQ(words_of_window("ru", site)->code(), "ru") << "the option overrides the site";
    site.language = "nobody";
    EXPECT_EQ(words_of_window({}, site)->say("Scan"), "Scan");
    EXPECT_EQ(words_of_window({}, {})->code(), "en") << "whatever LANG is";
}

TEST_F(SitesWords, EveryWindowHasTheSitesLanguageAndThemeWhereNoneIsAskedFor) {
    SiteSettings site;
    site.language = "de";
    site.theme = "bright";
    EXPECT_EQ(settings_of_window({}, {}, site).theme, ThemeKind::bright);
    EXPECT_EQ(settings_of_window({}, {}, site).words->code(), "de");
    EXPECT_EQ(settings_of_window("ru", "dark", site).theme, ThemeKind::dark) << "the options override the site";
    EXPECT_EQ(settings_of_window("ru", "dark", site).words->code(), "ru");
}

}  // namespace
}  // namespace planlight
