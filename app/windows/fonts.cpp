#include "app/windows/fonts.h"

#include <imgui.h>
#include <imgui_internal.h>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

const std::filesystem::path kInter = "/usr/share/fonts/opentype/inter";
const std::filesystem::path kDejaVu = "/usr/share/fonts/truetype/dejavu";

// Latin with accents, Greek, Cyrillic (names), punctuation, super- and subscripts, arrows, mathematics, the diameter
// sign.
const ImWchar kText[] = {0x20,   0x17F,  0x370,  0x3FF,  0x400,  0x45F,  0x2010, 0x2027, 0x2030, 0x203A, 0x2070, 0x209C,
                         0x20AC, 0x20AC, 0x2122, 0x2122, 0x2190, 0x2199, 0x2202, 0x2265, 0x2300, 0x2300, 0};
const ImWchar kWordOnly[] = {0x20, 0x7E, 0};

/// Adds one size, completed from the symbol font.
ImFont* add(ImFontAtlas& atlas, const std::filesystem::path& file, const std::filesystem::path& symbols, float pixels,
            const ImWchar* ranges) {
    ImFontConfig config;
    config.OversampleH = pixels > 40 ? 1 : 2;
    config.OversampleV = 1;
    config.PixelSnapH = true;
    ImFont* const font = atlas.AddFontFromFileTTF(file.c_str(), pixels, &config, ranges);
    if (font == nullptr)
        throw DeviceError("Font " + file.string(), "it cannot be read", "Install the package fonts-inter again.");
    if (!symbols.empty() && ranges == kText) {
        config.MergeMode = true;
        atlas.AddFontFromFileTTF(symbols.c_str(), pixels, &config, ranges);
    }
    return font;
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

FontSet load_fonts(ImFontAtlas& atlas, const FontFiles& files, float scale) {
    atlas.TexDesiredWidth = 4096;
    const auto size = [&](float pixels, float least) { return std::max(std::round(pixels * scale), least); };
    FontSet fonts{};
    fonts.body = add(atlas, files.regular, files.symbols, size(26, 19), kText);
    fonts.small = add(atlas, files.regular, files.symbols, size(21, 16), kText);
    fonts.strong = add(atlas, files.bold, files.symbols, size(26, 19), kText);
    fonts.number = add(atlas, files.bold, files.symbols, size(34, 24), kText);
    fonts.title = add(atlas, files.bold, files.symbols, size(30, 22), kText);
    fonts.letter = add(atlas, files.bold, {}, size(36, 26), kWordOnly);
    fonts.word = add(atlas, files.bold, {}, size(120, 84), kWordOnly);
    atlas.Build();
    for (ImFont* font : atlas.Fonts)
        if (font->FindGlyphNoFallback(0x2300) == nullptr) font->AddRemapChar(0x2300, 0xD8);
    return fonts;
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
