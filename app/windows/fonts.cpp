#include "app/windows/fonts.h"

#include <imgui.h>
#include <imgui_internal.h>

#include <ft2build.h>
#include FT_FREETYPE_H

#include <algorithm>
#include <map>
#include <set>

#include "app/windows/layout.h"
#include "planning_io/types/error.h"
#include "projection/font_files.h"

namespace planlight {
namespace {

const std::filesystem::path kInter = "/usr/share/fonts/opentype/inter";
const std::filesystem::path kDejaVu = "/usr/share/fonts/truetype/dejavu";

// Latin with accents, Greek, Cyrillic (names), punctuation, super- and subscripts, arrows, mathematics, the diameter
// sign.
const ImWchar kText[] = {0x20,   0x17F,  0x370,  0x3FF,  0x400,  0x45F,  0x2010, 0x2027, 0x2030, 0x203A, 0x2070, 0x209C,
                         0x20AC, 0x20AC, 0x2122, 0x2122, 0x2190, 0x2199, 0x2202, 0x2265, 0x2300, 0x2300, 0};
const ImWchar kWordOnly[] = {0x20, 0x7E, 0};

std::set<unsigned> codes_of(const std::string& text) {
    std::set<unsigned> codes;
    for (const char* at = text.c_str(); *at != '\0';) {
        unsigned code = 0;
        at += ImTextCharFromUtf8(&code, at, nullptr);
        if (code > 0x20 && code <= 0xFFFF && code != 0xFFFD) codes.insert(code);
    }
    return codes;
}

/// Those ranges and the letters, as Dear ImGui wants them: pairs, then 0.
std::vector<ImWchar> ranges_with(const ImWchar* ranges, const std::set<unsigned>& codes) {
    std::vector<ImWchar> all;
    for (; *ranges != 0; ++ranges) all.push_back(*ranges);
    for (const unsigned code : codes) all.insert(all.end(), 2, static_cast<ImWchar>(code));
    all.push_back(0);
    return all;
}

/// A font file for letters that the usual ones lack, and which of them it has.
struct MoreLetters {
    FontFile font;
    std::vector<ImWchar> ranges;
};

/// Where this computer has those letters, each in the first font that has it.
std::vector<MoreLetters> fonts_for(std::set<unsigned> codes) {
    std::vector<MoreLetters> found;
    FT_Library library = nullptr;
    if (codes.empty() || FT_Init_FreeType(&library) != 0) return found;
    for (const FontFile& font : font_files()) {
        FT_Face face = nullptr;
        if (codes.empty()) break;
        if (FT_New_Face(library, font.file.c_str(), font.index, &face) != 0) continue;
        std::set<unsigned> here;
        for (const unsigned code : codes)
            if (FT_Get_Char_Index(face, code) != 0) here.insert(code);
        FT_Done_Face(face);
        constexpr ImWchar kNone[] = {0};
        if (!here.empty()) found.push_back({font, ranges_with(kNone, here)});
        for (const unsigned code : here) codes.erase(code);
    }
    FT_Done_FreeType(library);
    return found;
}

/// Adds one size, completed from the symbol font, and from others.
ImFont* add(ImFontAtlas& atlas, const std::filesystem::path& file, const std::filesystem::path& symbols, float pixels,
            const ImWchar* ranges, const std::vector<MoreLetters>& more) {
    ImFontConfig config;
    config.OversampleH = pixels > 40 ? 1 : 2;
    config.OversampleV = 1;
    config.PixelSnapH = true;
    ImFont* const font = atlas.AddFontFromFileTTF(file.c_str(), pixels, &config, ranges);
    if (font == nullptr)
        throw DeviceError("Font " + file.string(), "it cannot be read", "Install the package fonts-inter again.");
    config.MergeMode = true;
    if (!symbols.empty()) atlas.AddFontFromFileTTF(symbols.c_str(), pixels, &config, ranges);
    for (const MoreLetters& one : more) {
        config.FontNo = one.font.index;
        atlas.AddFontFromFileTTF(one.font.file.c_str(), pixels, &config, one.ranges.data());
    }
    return font;
}

/// The ranges and the fonts of one loading; they live until the atlas is built.
struct Loading {
    std::vector<ImWchar> text, word;
    std::vector<MoreLetters> more;
};

FontSet load(ImFontAtlas& atlas, const FontFiles& files, float scale, const Loading& l) {
    atlas.Clear();
    atlas.TexDesiredWidth = 4096;
    // The least sizes are those of a window that is not shrunk.
    const auto size = [&](float pixels, float least) {
        return std::max(std::round(pixels * scale), std::round(least * std::min(1.0F, scale / kLeastScale)));
    };
    const auto text = [&](const std::filesystem::path& file, float pixels) {
        return add(atlas, file, files.symbols, pixels, l.text.data(), l.more);
    };
    FontSet fonts{};
    fonts.body = text(files.regular, size(26, 19));
    fonts.small = text(files.regular, size(21, 16));
    fonts.strong = text(files.bold, size(26, 19));
    fonts.number = text(files.bold, size(34, 24));
    fonts.title = text(files.bold, size(30, 22));
    fonts.letter = add(atlas, files.bold, {}, size(36, 26), kWordOnly, {});
    fonts.word = add(atlas, files.bold, {}, size(120, 84), l.word.data(), l.more);
    atlas.Build();
    return fonts;
}

bool blank_is_right(unsigned code) {
    return code == ' ' || code == '\n' || code == 0xA0;
}

}  // namespace

FontFiles find_fonts() {
    namespace fs = std::filesystem;
    const fs::path symbols = fs::exists(kDejaVu / "DejaVuSans.ttf") ? kDejaVu / "DejaVuSans.ttf" : fs::path{};
    if (fs::exists(kInter / "Inter-Regular.otf") && fs::exists(kInter / "Inter-Bold.otf"))
        return {kInter / "Inter-Regular.otf", kInter / "Inter-Bold.otf", symbols};
    if (!symbols.empty() && fs::exists(kDejaVu / "DejaVuSans-Bold.ttf"))
        return {symbols, kDejaVu / "DejaVuSans-Bold.ttf", symbols};
    throw DeviceError("Font", "neither Inter nor DejaVu Sans is installed",
                      "Install a font: apt-get install fonts-inter fonts-dejavu-core.");
}

FontSet load_fonts(ImFontAtlas& atlas, const FontFiles& files, float scale, const FontLetters& letters) {
    const std::set<unsigned> codes = codes_of(letters.text + letters.word);
    Loading loading{ranges_with(kText, codes), ranges_with(kWordOnly, codes_of(letters.word)), {}};
    FontSet fonts = load(atlas, files, scale, loading);
    std::set<unsigned> missing;
    for (const unsigned code : codes)
        if (fonts.body->FindGlyphNoFallback(static_cast<ImWchar>(code)) == nullptr) missing.insert(code);
    loading.more = fonts_for(missing);
    if (!loading.more.empty()) fonts = load(atlas, files, scale, loading);
    for (ImFont* font : atlas.Fonts)
        if (font->FindGlyphNoFallback(0x2300) == nullptr) font->AddRemapChar(0x2300, 0xD8);
    return fonts;
}

std::string utf8_of(unsigned code) {
    char text[5] = {};
    ImTextCharToUtf8(text, code);
    return text;
}

std::vector<std::string> missing_glyphs(const ImFont& font, const std::string& text) {
    std::vector<std::string> missing;
    for (const char* at = text.c_str(); *at != '\0';) {
        unsigned code = 0;
        const int bytes = ImTextCharFromUtf8(&code, at, nullptr);
        const ImFontGlyph* const glyph = font.FindGlyphNoFallback(static_cast<ImWchar>(code));
        const bool shown = glyph != nullptr && (glyph->Visible || blank_is_right(code));
        if (!shown && code != '\n') missing.emplace_back(at, static_cast<std::size_t>(bytes));
        at += bytes;
    }
    return missing;
}

}  // namespace planlight
