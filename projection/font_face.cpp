#include "projection/font_face.h"

#include FT_OUTLINE_H
#include <hb.h>

#include <algorithm>
#include <cmath>

#include "projection/text_signs.h"

namespace planlight {
namespace {

using Eigen::Vector2d;

/// Collects an outline from FreeType, curves cut into short lines.
struct OutlinePen {
    Sign sign;
    double unit;
    static constexpr double kStraight = 0.22, kCurved = 0.11;  // longest piece, of a capital's height

    static Vector2d at(const FT_Vector* v) { return {static_cast<double>(v->x) / 64, static_cast<double>(v->y) / 64}; }
    void move(const Vector2d& p) { sign.outlines.push_back({p}); }
    template <class Curve>
    void follow(double length, double piece, const Curve& curve) {
        const int n = std::max(1, static_cast<int>(std::ceil(length / (piece * unit))));
        for (int k = 1; k <= n; ++k) sign.outlines.back().push_back(curve(static_cast<double>(k) / n));
    }
    void line(const Vector2d& b) {
        const Vector2d a = sign.outlines.back().back();
        follow((b - a).norm(), kStraight, [&](double t) { return Vector2d(a + t * (b - a)); });
    }
    void conic(const Vector2d& c, const Vector2d& b) {
        const Vector2d a = sign.outlines.back().back();
        follow((c - a).norm() + (b - c).norm(), kCurved,
               [&](double t) { return Vector2d((1 - t) * (1 - t) * a + 2 * t * (1 - t) * c + t * t * b); });
    }
    void cubic(const Vector2d& c, const Vector2d& d, const Vector2d& b) {
        const Vector2d a = sign.outlines.back().back();
        follow((c - a).norm() + (d - c).norm() + (b - d).norm(), kCurved, [&](double t) {
            const double s = 1 - t;
            return Vector2d(s * s * s * a + 3 * s * s * t * c + 3 * s * t * t * d + t * t * t * b);
        });
    }
};

OutlinePen& pen_of(void* user) {
    return *static_cast<OutlinePen*>(user);
}

}  // namespace

FontFace::FontFace(FT_Library library, const FontFile& font) : family(font.family) {
    if (FT_New_Face(library, font.file.c_str(), font.index, &face_) != 0) {
        face_ = nullptr;
        return;
    }
    if (!FT_IS_SCALABLE(face_) || face_->units_per_EM == 0 || FT_Select_Charmap(face_, FT_ENCODING_UNICODE) != 0) {
        FT_Done_Face(face_);
        face_ = nullptr;
        return;
    }
    FT_Set_Char_Size(face_, face_->units_per_EM * 64, 0, 72, 72);  // one font unit is one pixel
    shaper_ = hb_ft_font_create_referenced(face_);
    hb_ft_font_set_load_flags(shaper_, FT_LOAD_NO_HINTING | FT_LOAD_NO_BITMAP);
}

FontFace::~FontFace() {
    if (shaper_) hb_font_destroy(shaper_);
    if (face_) FT_Done_Face(face_);
}

bool FontFace::has_all(const std::u32string& cluster) const {
    char32_t before = 0;
    for (const char32_t code : cluster) {
        if (has_no_ink(code)) continue;
        hb_codepoint_t both = 0;
        const bool whole =
            before && hb_unicode_compose(hb_unicode_funcs_get_default(), before, code, &both) && has(both);
        if (!whole && !has(code)) return false;
        before = whole ? both : code;
    }
    return true;
}

double FontFace::capital_units() const {
    const FT_UInt glyph = FT_Get_Char_Index(face_, 'H');
    if (glyph != 0 && FT_Load_Glyph(face_, glyph, kLoad) == 0 && face_->glyph->metrics.horiBearingY > 0)
        return static_cast<double>(face_->glyph->metrics.horiBearingY) / 64;
    return 0.72 * face_->units_per_EM;
}

const Sign& FontFace::glyph(unsigned index, double unit) {
    const auto known = glyphs_.find(index);
    if (known != glyphs_.end()) return known->second;
    OutlinePen pen{{}, unit};
    if (FT_Load_Glyph(face_, index, kLoad) == 0 && face_->glyph->format == FT_GLYPH_FORMAT_OUTLINE) {
        FT_Outline_Funcs ways{};
        ways.move_to = [](const FT_Vector* to, void* user) {
            pen_of(user).move(OutlinePen::at(to));
            return 0;
        };
        ways.line_to = [](const FT_Vector* to, void* user) {
            pen_of(user).line(OutlinePen::at(to));
            return 0;
        };
        ways.conic_to = [](const FT_Vector* c, const FT_Vector* to, void* user) {
            pen_of(user).conic(OutlinePen::at(c), OutlinePen::at(to));
            return 0;
        };
        ways.cubic_to = [](const FT_Vector* c, const FT_Vector* d, const FT_Vector* to, void* user) {
            pen_of(user).cubic(OutlinePen::at(c), OutlinePen::at(d), OutlinePen::at(to));
            return 0;
        };
        FT_Outline_Decompose(&face_->glyph->outline, &ways, &pen);
    }
    for (auto& outline : pen.sign.outlines) {  // the last side of each, as finely as the others
        if (outline.size() < 2) continue;
        const Vector2d first = outline.front(), last = outline.back();
        const double length = (last - first).norm();
        const int n = static_cast<int>(std::ceil(length / (OutlinePen::kStraight * unit)));
        if (n <= 0) outline.pop_back();
        for (int k = 1; k < n; ++k) outline.push_back(last + (first - last) * k / n);
    }
    std::erase_if(pen.sign.outlines, [](const auto& outline) { return outline.size() < 3; });
    return glyphs_.emplace(index, std::move(pen.sign)).first->second;
}

}  // namespace planlight
