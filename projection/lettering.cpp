#include "projection/lettering.h"

#include <hb.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>

#include "planning_io/types/reading_direction.h"
#include "projection/font_face.h"
#include "projection/stroke_font.h"
#include "projection/text_signs.h"
#include "projection/visual_order.h"

namespace planlight {
namespace {

using Eigen::Vector2d;

/// A piece of text of one font, script and direction.
struct Run {
    std::size_t begin, end;
    int font;
    std::int8_t level;  ///< even: read from the left, odd: from the right
    hb_script_t script;
};

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

/// A point or comma within a number: the smallest sign of all, and where it is not seen 7.5 is read as 75.
bool parts_a_number(const std::u32string& text, std::size_t at) {
    const auto digit = [&](std::size_t i) { return i < text.size() && text[i] >= U'0' && text[i] <= U'9'; };
    return at > 0 && at < text.size() && (text[at] == U'.' || text[at] == U',') && digit(at - 1) && digit(at + 1);
}
constexpr double kLargerPoint = 1.6;

/// From left to right as they are read (Unicode annex 9, rule L2).
void put_in_order(std::vector<Run>& runs) {
    std::int8_t highest = 0;
    for (const Run& run : runs) highest = std::max(highest, run.level);
    for (std::int8_t level = highest; level > 0; --level)
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
            if (FontFace* face = open(i)) first = face;
        if (first) {
            first->used = true;
            capital_em = first->capital_units() / first->units_per_em();
        }
    }
    ~Parts() {
        faces.clear();
        if (library) FT_Done_FreeType(library);
    }
    FontFace* open(std::size_t i) {
        if (!faces[i]) faces[i] = std::make_unique<FontFace>(library, fonts[i]);
        return faces[i]->usable() ? faces[i].get() : nullptr;
    }
    /// The first font that has the whole cluster; -1: none.
    int font_for(const std::u32string& cluster) {
        const auto known = font_of.find(cluster);
        if (known != font_of.end()) return known->second;
        int found = -1;
        for (std::size_t i = 0; i < fonts.size() && found < 0; ++i)
            if (FontFace* face = open(i); face && face->has_all(cluster)) found = static_cast<int>(i);
        return font_of[cluster] = found;
    }
    bool take_runs(const std::u32string& text, std::vector<Run>& runs, TextOutline& out);
    void shape(const std::u32string& text, const Run& run, TextOutline& out);
    TextOutline by_single_lines(const std::u32string& text) const;

    std::mutex in_use;
    FT_Library library = nullptr;
    std::vector<FontFile> fonts;
    std::vector<std::unique_ptr<FontFace>> faces;
    FontFace* first = nullptr;
    double capital_em = 0.73;  ///< of the first font: all fonts are drawn with its size of an em
    std::map<std::u32string, int> font_of;
};

bool Lettering::Parts::take_runs(const std::u32string& text, std::vector<Run>& runs, TextOutline& out) {
    const auto levels = reading_levels(text);
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
    FontFace& face = *faces[static_cast<std::size_t>(run.font)];
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
        const double larger = parts_a_number(text, infos[i].cluster) ? kLargerPoint : 1;
        const double advance = scale * places[i].x_advance / 64;
        const Vector2d aside((1 - larger) * advance / 4, 0);  // in the middle of half as much more room
        Sign sign = face.glyph(infos[i].codepoint, capital_units);
        for (auto& outline : sign.outlines)
            for (Vector2d& p : outline) p = origin + aside + larger * scale * p;
        if (!sign.outlines.empty()) out.signs.push_back(std::move(sign));
        out.width += advance * (1 + larger) / 2;
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
    std::erase_if(text, [](char32_t code) { return is_control(code) || orders_direction(code); });
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

}  // namespace planlight
