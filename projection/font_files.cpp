#include "projection/font_files.h"

#include <fontconfig/fontconfig.h>

#include <algorithm>
#include <cstdlib>
#include <memory>

namespace planlight {
namespace {

template <class T>
using Owned = std::unique_ptr<T, void (*)(T*)>;

/// Upright and of usual weight and width; the first families before all others.
int rank_of(FcPattern* font) {
    int slant = 0, weight = 0, width = FC_WIDTH_NORMAL;
    FcPatternGetInteger(font, FC_SLANT, 0, &slant);
    FcPatternGetInteger(font, FC_WEIGHT, 0, &weight);
    FcPatternGetInteger(font, FC_WIDTH, 0, &width);
    const bool plain =
        slant == FC_SLANT_ROMAN && std::abs(weight - FC_WEIGHT_REGULAR) <= 20 && width == FC_WIDTH_NORMAL;
    FcChar8* family = nullptr;
    FcPatternGetString(font, FC_FAMILY, 0, &family);
    const std::string name = family ? reinterpret_cast<const char*>(family) : "";
    if (plain && name == "DejaVu Sans") return 0;
    if (plain && name == "WenQuanYi Micro Hei") return 1;
    if (name.find("Sans") != std::string::npos) return plain ? 2 : 4;
    return plain ? 3 : 5;
}

std::vector<FontFile> fonts_of(const FcFontSet& set) {
    std::vector<std::pair<int, FontFile>> ranked;
    for (int i = 0; i < set.nfont; ++i) {
        FcPattern* font = set.fonts[i];
        FcChar8 *file = nullptr, *family = nullptr;
        int index = 0;
        FcBool variable = FcFalse, symbol = FcFalse;
        FcPatternGetBool(font, FC_VARIABLE, 0, &variable);
        FcPatternGetBool(font, FC_SYMBOL, 0, &symbol);
        if (variable || symbol || FcPatternGetString(font, FC_FILE, 0, &file) != FcResultMatch) continue;
        FcPatternGetInteger(font, FC_INDEX, 0, &index);
        FcPatternGetString(font, FC_FAMILY, 0, &family);
        ranked.push_back({rank_of(font),
                          {reinterpret_cast<const char*>(file), index,
                           family ? reinterpret_cast<const char*>(family) : std::string()}});
    }
    std::sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) {
        return std::tie(a.first, a.second.file, a.second.index) < std::tie(b.first, b.second.file, b.second.index);
    });
    std::vector<FontFile> files;
    for (auto& [rank, file] : ranked) files.push_back(std::move(file));
    return files;
}

}  // namespace

std::vector<FontFile> font_files() {
    std::vector<FontFile> files;
    const Owned<FcConfig> config(FcInitLoadConfigAndFonts(), FcConfigDestroy);
    const Owned<FcPattern> wanted(FcPatternBuild(nullptr, FC_OUTLINE, FcTypeBool, FcTrue, FC_SCALABLE, FcTypeBool,
                                                 FcTrue, static_cast<char*>(nullptr)),
                                  FcPatternDestroy);
    const Owned<FcObjectSet> facts(FcObjectSetBuild(FC_FILE, FC_INDEX, FC_FAMILY, FC_SLANT, FC_WEIGHT, FC_WIDTH,
                                                    FC_VARIABLE, FC_SYMBOL, static_cast<char*>(nullptr)),
                                   FcObjectSetDestroy);
    if (config && wanted && facts) {
        const Owned<FcFontSet> found(FcFontList(config.get(), wanted.get(), facts.get()), FcFontSetDestroy);
        if (found) files = fonts_of(*found);
    }
    if (const char* own = std::getenv("PLANLIGHT_FONT"); own && *own)
        files.insert(files.begin(), FontFile{own, 0, own});
    return files;
}

}  // namespace planlight
