#pragma once

#include <ft2build.h>
#include FT_FREETYPE_H
#include <hb-ft.h>

#include <map>
#include <string>

#include "projection/font_files.h"
#include "projection/lettering.h"

namespace planlight {

/// One font by FreeType and HarfBuzz: which letters it has, and their outlines. Of `Lettering` alone, under its lock.
class FontFace {
public:
    FontFace(FT_Library library, const FontFile& font);
    FontFace(const FontFace&) = delete;
    FontFace& operator=(const FontFace&) = delete;
    ~FontFace();
    bool usable() const { return face_ != nullptr; }
    bool has(char32_t code) const { return FT_Get_Char_Index(face_, code) != 0; }
    /// A letter and its accents: also when only the two together are one sign of the font.
    bool has_all(const std::u32string& cluster) const;
    double capital_units() const;
    double units_per_em() const { return face_->units_per_EM; }
    hb_font_t* shaper() const { return shaper_; }
    /// Outlines in font units, straight or as fine as `unit` (a capital's height) asks.
    const Sign& glyph(unsigned index, double unit);

    std::string family;
    mutable bool used = false;

private:
    static constexpr FT_Int32 kLoad = FT_LOAD_NO_HINTING | FT_LOAD_NO_BITMAP;
    FT_Face face_ = nullptr;
    hb_font_t* shaper_ = nullptr;
    std::map<unsigned, Sign> glyphs_;
};

}  // namespace planlight
