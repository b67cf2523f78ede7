#include "projection/lettering.h"

#include <fribidi/fribidi.h>
#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H
#include <hb-ft.h>
#include <hb.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>

#include "projection/stroke_font.h"

namespace planlight {
namespace {

using Eigen::Vector2d;

bool is_mark(char32_t code) {
    const auto category = hb_unicode_general_category(hb_unicode_funcs_get_default(), code);
    return category == HB_UNICODE_GENERAL_CATEGORY_NON_SPACING_MARK ||
           category == HB_UNICODE_GENERAL_CATEGORY_SPACING_MARK ||
           category == HB_UNICODE_GENERAL_CATEGORY_ENCLOSING_MARK;
}

/// Signs that have no ink of their own: joiners, marks of direction, variants.
bool has_no_ink(char32_t code) {
    return code == 0x00AD || code == 0x034F || code == 0x061C || (code >= 0x200B && code <= 0x200F) ||
           (code >= 0x202A && code <= 0x202E) || (code >= 0x2060 && code <= 0x206F) || code == 0xFEFF ||
           (code >= 0xFE00 && code <= 0xFE0F) || (code >= 0xE0100 && code <= 0xE01EF);
}

bool belongs_to_the_one_before(char32_t code) {
    return is_mark(code) || has_no_ink(code);
}

bool is_control(char32_t code) {
    return code < 0x20 || (code >= 0x7F && code < 0xA0);
}

/// A damaged byte, or a sign that means something else in every font.
bool is_no_letter(char32_t code) {
    return code == 0xFFFD ||
           hb_unicode_general_category(hb_unicode_funcs_get_default(), code) == HB_UNICODE_GENERAL_CATEGORY_PRIVATE_USE;
}

/// Where each reader's sign begins, and the end.
std::vector<std::size_t> clusters_of(const std::u32string& text) {
    std::vector<std::size_t> begins;
    for (std::size_t i = 0; i < text.size(); ++i)
        if (i == 0 || !belongs_to_the_one_before(text[i])) {
            const bool joined = i > 0 && text[i - 1] == 0x200D;  // a zero width joiner
            if (!joined) begins.push_back(i);
        }
    begins.push_back(text.size());
    return begins;
}

class Face {
public:
    Face(FT_Library library, const FontFile& font) : family(font.family) {
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
    Face(const Face&) = delete;
    Face& operator=(const Face&) = delete;
    ~Face() {
        if (shaper_) hb_font_destroy(shaper_);
        if (face_) FT_Done_Face(face_);
    }
    bool usable() const { return face_ != nullptr; }
    bool has(char32_t code) const { return FT_Get_Char_Index(face_, code) != 0; }
    /// A letter and its accents: also when only the two together are one sign of the font.
    bool has_all(const std::u32string& cluster) const {
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
    double capital_units() const {
        const FT_UInt glyph = FT_Get_Char_Index(face_, 'H');
        if (glyph != 0 && FT_Load_Glyph(face_, glyph, kLoad) == 0 && face_->glyph->metrics.horiBearingY > 0)
            return static_cast<double>(face_->glyph->metrics.horiBearingY) / 64;
        return 0.72 * face_->units_per_EM;
    }
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

const Sign& Face::glyph(unsigned index, double unit) {
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

/// A piece of text of one font, script and direction.
struct Run {
    std::size_t begin, end;
    int font;
    FriBidiLevel level;
    hb_script_t script;
};

std::vector<FriBidiLevel> levels_of(const std::u32string& text) {
    const auto n = static_cast<FriBidiStrIndex>(text.size());
    const auto* codes = reinterpret_cast<const FriBidiChar*>(text.data());
    std::vector<FriBidiCharType> types(text.size());
    std::vector<FriBidiBracketType> brackets(text.size());
    std::vector<FriBidiLevel> levels(text.size(), 0);
    fribidi_get_bidi_types(codes, n, types.data());
    fribidi_get_bracket_types(codes, n, types.data(), brackets.data());
    FriBidiParType whole = FRIBIDI_PAR_ON;
    if (fribidi_get_par_embedding_levels_ex(types.data(), brackets.data(), n, &whole, levels.data()) == 0)
        std::fill(levels.begin(), levels.end(), FriBidiLevel{0});
    return levels;
}

/// Scripts, those of signs that all share (digits, blanks) taken from their neighbours.
std::vector<hb_script_t> scripts_of(const std::u32string& text) {
    std::vector<hb_script_t> scripts;
    const auto shared = [](hb_script_t s) {
        return s == HB_SCRIPT_COMMON || s == HB_SCRIPT_INHERITED || s == HB_SCRIPT_UNKNOWN;
    };
    for (const char32_t code : text) scripts.push_back(hb_unicode_script(hb_unicode_funcs_get_default(), code));
    for (std::size_t i = 1; i < scripts.size(); ++i)
        if (shared(scripts[i])) scripts[i] = scripts[i - 1];
    for (std::size_t i = scripts.size(); i-- > 1;)
        if (shared(scripts[i - 1])) scripts[i - 1] = shared(scripts[i]) ? HB_SCRIPT_LATIN : scripts[i];
    if (scripts.size() == 1 && shared(scripts[0])) scripts[0] = HB_SCRIPT_LATIN;
    return scripts;
}

/// From left to right as they are read (Unicode annex 9, rule L2).
void put_in_order(std::vector<Run>& runs) {
    FriBidiLevel highest = 0;
    for (const Run& run : runs) highest = std::max(highest, run.level);
    for (FriBidiLevel level = highest; level > 0; --level)
        for (std::size_t i = 0; i < runs.size(); ++i) {
            std::size_t end = i;
            while (end < runs.size() && runs[end].level >= level) ++end;
            if (end > i + 1)
                std::reverse(runs.begin() + static_cast<std::ptrdiff_t>(i),
                             runs.begin() + static_cast<std::ptrdiff_t>(end));
            i = std::max(i, end);
        }
}

}  // namespace

struct Lettering::Parts {
    explicit Parts(const std::vector<FontFile>& files) : fonts(files) {
        if (FT_Init_FreeType(&library) != 0) library = nullptr;
        if (library == nullptr) fonts.clear();
        faces.resize(fonts.size());
        for (std::size_t i = 0; i < fonts.size() && !first; ++i)
            if (Face* face = open(i)) first = face;
        if (first) {
            first->used = true;
            capital_em = first->capital_units() / first->units_per_em();
        }
    }
    ~Parts() {
        faces.clear();
        if (library) FT_Done_FreeType(library);
    }
    Face* open(std::size_t i) {
        if (!faces[i]) faces[i] = std::make_unique<Face>(library, fonts[i]);
        return faces[i]->usable() ? faces[i].get() : nullptr;
    }
    /// The first font that has the whole cluster; -1: none.
    int font_for(const std::u32string& cluster) {
        const auto known = font_of.find(cluster);
        if (known != font_of.end()) return known->second;
        int found = -1;
        for (std::size_t i = 0; i < fonts.size() && found < 0; ++i)
            if (Face* face = open(i); face && face->has_all(cluster)) found = static_cast<int>(i);
        return font_of[cluster] = found;
    }
    bool take_runs(const std::u32string& text, std::vector<Run>& runs, TextOutline& out);
    void shape(const std::u32string& text, const Run& run, TextOutline& out);
    TextOutline by_single_lines(const std::u32string& text) const;

    std::mutex in_use;
    FT_Library library = nullptr;
    std::vector<FontFile> fonts;
    std::vector<std::unique_ptr<Face>> faces;
    Face* first = nullptr;
    double capital_em = 0.73;  ///< of the first font: all fonts are drawn with its size of an em
    std::map<std::u32string, int> font_of;
};

bool Lettering::Parts::take_runs(const std::u32string& text, std::vector<Run>& runs, TextOutline& out) {
    const auto levels = levels_of(text);
    const auto scripts = scripts_of(text);
    const auto begins = clusters_of(text);
    for (std::size_t c = 0; c + 1 < begins.size(); ++c) {
        const std::size_t begin = begins[c], end = begins[c + 1];
        const int font = font_for(text.substr(begin, end - begin));
        if (font < 0) {
            for (std::size_t i = begin; i < end; ++i)
                if (!has_no_ink(text[i])) out.lacks.push_back(text[i]);
            continue;
        }
        if (!runs.empty() && runs.back().end == begin && runs.back().font == font &&
            runs.back().level == levels[begin] && runs.back().script == scripts[begin])
            runs.back().end = end;
        else
            runs.push_back({begin, end, font, levels[begin], scripts[begin]});
    }
    return out.lacks.empty();
}

void Lettering::Parts::shape(const std::u32string& text, const Run& run, TextOutline& out) {
    Face& face = *faces[static_cast<std::size_t>(run.font)];
    face.used = true;
    hb_buffer_t* buffer = hb_buffer_create();
    hb_buffer_add_utf32(buffer, reinterpret_cast<const std::uint32_t*>(text.data()), static_cast<int>(text.size()),
                        static_cast<unsigned>(run.begin), static_cast<int>(run.end - run.begin));
    hb_buffer_set_direction(buffer, run.level % 2 ? HB_DIRECTION_RTL : HB_DIRECTION_LTR);
    hb_buffer_set_script(buffer, run.script);
    hb_buffer_set_language(buffer, hb_language_from_string("und", -1));
    hb_shape(face.shaper(), buffer, nullptr, 0);
    unsigned count = 0;
    const auto* infos = hb_buffer_get_glyph_infos(buffer, &count);
    const auto* places = hb_buffer_get_glyph_positions(buffer, &count);
    const double capital_units = capital_em * face.units_per_em(), scale = 1 / capital_units;
    for (unsigned i = 0; i < count; ++i) {
        if (infos[i].codepoint == 0)  // the font has the letters and yet no shape for them
            out.lacks.push_back(text[std::min<std::size_t>(infos[i].cluster, text.size() - 1)]);
        const Vector2d origin(out.width + scale * places[i].x_offset / 64, scale * places[i].y_offset / 64);
        Sign sign = face.glyph(infos[i].codepoint, capital_units);
        for (auto& outline : sign.outlines)
            for (Vector2d& p : outline) p = origin + scale * p;
        if (!sign.outlines.empty()) out.signs.push_back(std::move(sign));
        out.width += scale * places[i].x_advance / 64;
    }
    hb_buffer_destroy(buffer);
}

/// Without any font: each line of the single-line font as a narrow outline.
TextOutline Lettering::Parts::by_single_lines(const std::u32string& text) const {
    constexpr double kHalf = 0.055;
    TextOutline out;
    for (const char32_t code : text) {
        if (!is_known_glyph(code)) {
            out.lacks.push_back(code);
            continue;
        }
        const Glyph g = glyph(code);
        Sign sign;
        for (const auto& way : g.lines)
            for (std::size_t i = 0; i + 1 < way.size(); ++i) {
                const Vector2d a = way[i], b = way[i + 1];
                if (a == b) continue;
                const Vector2d along = kHalf * (b - a).normalized(), aside(-along.y(), along.x()), at(out.width, 0);
                sign.outlines.push_back(
                    {at + a - along - aside, at + b + along - aside, at + b + along + aside, at + a - along + aside});
            }
        if (!sign.outlines.empty()) out.signs.push_back(std::move(sign));
        out.width += g.advance;
    }
    return out;
}

Lettering::Lettering(const std::vector<FontFile>& fonts) : parts_(std::make_unique<Parts>(fonts)) {}
Lettering::~Lettering() = default;

TextOutline Lettering::outline(const std::string& utf8) const {
    std::u32string text = code_points(utf8);
    std::erase_if(text, is_control);
    TextOutline out;
    if (text.empty()) return out;
    std::copy_if(text.begin(), text.end(), std::back_inserter(out.lacks), is_no_letter);
    if (!out.lacks.empty()) return out;
    const std::lock_guard lock(parts_->in_use);
    if (parts_->first == nullptr) {
        out = parts_->by_single_lines(text);
    } else {
        std::vector<Run> runs;
        if (!parts_->take_runs(text, runs, out)) return out;
        put_in_order(runs);
        for (const Run& run : runs) parts_->shape(text, run, out);
    }
    out.low = 1e9, out.high = -1e9;
    for (const Sign& sign : out.signs)
        for (const auto& outline : sign.outlines)
            for (const Vector2d& p : outline) out.low = std::min(out.low, p.y()), out.high = std::max(out.high, p.y());
    if (out.signs.empty()) out.low = out.high = 0;
    return out;
}

std::vector<std::string> Lettering::families() const {
    const std::lock_guard lock(parts_->in_use);
    std::vector<std::string> names;
    for (const auto& face : parts_->faces)
        if (face && face->usable() && face->used) names.push_back(face->family);
    return names;
}

const Lettering& lettering() {
    static const Lettering kOfThisComputer(font_files());
    return kOfThisComputer;
}

std::vector<std::string> readers_signs(const std::string& utf8) {
    const std::u32string text = code_points(utf8);
    const auto begins = clusters_of(text);
    std::vector<std::string> signs;
    for (std::size_t c = 0; c + 1 < begins.size(); ++c) {
        signs.emplace_back();
        for (std::size_t i = begins[c]; i < begins[c + 1]; ++i) signs.back() += utf8_of(text[i]);
    }
    return signs;
}

std::string utf8_of(char32_t code) {
    const auto byte = [](char32_t bits) { return static_cast<char>(static_cast<unsigned char>(bits)); };
    if (code < 0x80) return {byte(code)};
    if (code < 0x800) return {byte(0xC0 | (code >> 6)), byte(0x80 | (code & 0x3F))};
    if (code < 0x10000)
        return {byte(0xE0 | (code >> 12)), byte(0x80 | ((code >> 6) & 0x3F)), byte(0x80 | (code & 0x3F))};
    return {byte(0xF0 | (code >> 18)), byte(0x80 | ((code >> 12) & 0x3F)), byte(0x80 | ((code >> 6) & 0x3F)),
            byte(0x80 | (code & 0x3F))};
}

}  // namespace planlight
