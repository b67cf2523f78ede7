// The letters of the windows: every one that is shown exists.
#include "app/windows/fonts.h"

#include <gtest/gtest.h>
#include <imgui.h>

#include <filesystem>
#include <string>
#include <vector>

#include "app/windows/layout.h"
#include "app/windows/number_text.h"
#include "app/windows/panels.h"
#include "fake_model.h"
#include "projection/visual_order.h"

namespace planlight {
namespace {

/// The fonts as the windows load them, without any window.
struct LoadedFonts {
    ImFontAtlas atlas;
    FontSet fonts;
    explicit LoadedFonts(const FontFiles& files, float scale = 1) : fonts(load_fonts(atlas, files, scale)) {}
};

// A planning station once showed "8_.5 mm": a digit replaced by a blank (FDA class I recall). Every number, every size.
TEST(Fonts, NoCharacterOfAnyNumberIsBlank) {
    const LoadedFonts loaded(find_fonts());
    const FontSet& f = loaded.fonts;
    for (const ImFont* font : {f.small, f.body, f.strong, f.number, f.title})
        for (int tenths = -9999; tenths <= 9999; ++tenths)
            ASSERT_TRUE(missing_glyphs(*font, number_text(tenths / 10.0, "mm")).empty()) << tenths / 10.0;
}

TEST(Fonts, EveryShownCharacterExistsInEverySize) {
    const std::string shown =
        "0123456789 .,:;-–—·°µ⌀±×≤≥≈…/()%+−√²³äöüÄÖÜßéèçñøåŁłšžΔσαβμДЖ "
        "The plan on the skin may be used. Overlay error now / s ABCDEFGHIJKLMNOPQRSTUVWXYZ abcdefghijklmnopqrstuvwxyz";
    for (const float scale : {0.6F, 1.0F, 1.5F}) {
        const LoadedFonts loaded(find_fonts(), scale);
        const FontSet& f = loaded.fonts;
        for (const ImFont* font : {f.small, f.body, f.strong, f.number, f.title})
            EXPECT_EQ(missing_glyphs(*font, shown), std::vector<std::string>{});
        for (const StatusKind kind : {StatusKind::ready, StatusKind::scanning, StatusKind::matching,
                                      StatusKind::aligned, StatusKind::check, StatusKind::refused, StatusKind::dark})
            EXPECT_TRUE(missing_glyphs(*f.word, status_word(kind)).empty()) << status_word(kind);
        EXPECT_EQ(missing_glyphs(*f.body, "a漢b"), std::vector<std::string>{"漢"}) << "what is missing is found out";
    }
}

// The patient's name, or the words of a language that the site added.
TEST(Fonts, LettersOfOtherScriptsComeFromOtherFontsOfTheComputer) {
    if (!std::filesystem::exists("/usr/share/fonts/truetype/wqy/wqy-microhei.ttc"))
        GTEST_SKIP() << "no fonts-wqy-microhei";
    ImFontAtlas atlas;
    const FontSet fonts = load_fonts(atlas, find_fonts(), 1, {"患者王小明", "准备"});
    for (const ImFont* font : {fonts.small, fonts.body, fonts.strong, fonts.number, fonts.title})
        EXPECT_EQ(missing_glyphs(*font, "患者: 王小明, 8.5 mm"), std::vector<std::string>{});
    EXPECT_EQ(missing_glyphs(*fonts.word, "准备"), std::vector<std::string>{});
}

// "B3 left sphenoid ... ⌀7  6 mm deep": the figures at the end are what is read from the row.
TEST(Fonts, ALongNameIsShortenedInTheMiddleAndKeepsItsFigures) {
    const LoadedFonts loaded(find_fonts());
    const ImFont* const font = loaded.fonts.body;
    const std::string name = "Bohrloch für die Schraube am linken Keilbeinflügel  ⌀7  6 mm deep";
    for (const float width : {160.0F, 240.0F, 400.0F}) {
        const std::string shown = shortened_in_the_middle(font, name, width);
        EXPECT_LE(text_width(font, shown), width);
        EXPECT_GT(text_width(font, shown), width - 40) << "no more than it takes";
        EXPECT_TRUE(shown.starts_with("Bohr")) << shown;
        EXPECT_TRUE(shown.ends_with("deep")) << shown;
        EXPECT_NE(shown.find("…"), std::string::npos) << shown;
    }
    EXPECT_EQ(shortened_in_the_middle(font, "B3", 160), "B3");
    EXPECT_EQ(shortened_in_the_middle(font, name, 3), "…");
}

TEST(Fonts, DejaVuAloneIsEnough) {
    const std::filesystem::path folder = "/usr/share/fonts/truetype/dejavu";
    if (!std::filesystem::exists(folder / "DejaVuSans.ttf")) GTEST_SKIP() << "fonts-dejavu-core is not installed";
    const LoadedFonts loaded({folder / "DejaVuSans.ttf", folder / "DejaVuSans-Bold.ttf", {}});
    EXPECT_TRUE(missing_glyphs(*loaded.fonts.body, "Borehole 1, ⌀ 7.0 mm · 1.2° – µ …").empty());
}

// 20 mm on a 24 inch screen of 1080 lines (299 mm high) are 72 pixels.
TEST(Fonts, TheStatusWordIsReadableAtFourMetres) {
    const LoadedFonts loaded(find_fonts());
    const ImFontGlyph* const letter = loaded.fonts.word->FindGlyphNoFallback('A');
    ASSERT_NE(letter, nullptr);
    EXPECT_GE(letter->Y1 - letter->Y0, 72);
}

TEST(Fonts, HaveTheLettersOfNamesThatAreReadFromTheRight) {
    ImFontAtlas atlas;
    const FontSet fonts = load_fonts(atlas, find_fonts(), 1, {visual_order("محمد אבג"), ""});
    EXPECT_EQ(missing_glyphs(*fonts.body, visual_order("محمد אבג")), std::vector<std::string>{});
}

}  // namespace
}  // namespace planlight
