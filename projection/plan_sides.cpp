#include "projection/plan_sides.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

namespace planlight {
namespace {

/// The code points of UTF-8; what is none counts as a space.
std::u32string decoded(const std::string& text) {
    std::u32string points;
    for (std::size_t i = 0; i < text.size();) {
        const auto byte = static_cast<unsigned char>(text[i]);
        const std::size_t more = byte < 0x80 ? 0 : byte >> 5 == 6 ? 1 : byte >> 4 == 14 ? 2 : byte >> 3 == 30 ? 3 : 4;
        char32_t point = more == 0 ? byte : byte & (0x3FU >> more);
        bool whole = more < 4 && i + more < text.size();
        for (std::size_t k = 1; whole && k <= more; ++k) {
            const auto next = static_cast<unsigned char>(text[i + k]);
            whole = next >> 6 == 2;
            point = point << 6 | (next & 0x3FU);
        }
        points += whole ? point : U' ';
        i += whole ? more + 1 : 1;
    }
    return points;
}

bool is_digit(char32_t c) {
    return c >= '0' && c <= '9';
}
/// Capitals of the scripts that sides are known in.
bool is_capital(char32_t c) {
    return (c >= 'A' && c <= 'Z') || (c >= 0xC0 && c <= 0xDE && c != 0xD7) || (c >= 0x400 && c <= 0x42F) || c == 0x11E;
}
char32_t lowered(char32_t c) {
    if (!is_capital(c)) return c;
    return c == 0x11E ? 0x11F : c >= 0x400 && c < 0x410 ? c + 0x50 : c + 0x20;
}
bool is_letter(char32_t c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           (c >= 0xC0 && c != 0xD7 && c != 0xF7 && !(c >= 0x2000 && c <= 0x2BFF) && !(c >= 0x3000 && c <= 0x303F) &&
            !(c >= 0xFE00 && c <= 0xFE6F) && !(c >= 0xFF00 && c <= 0xFF20));
}

/// In small letters. "TrepRight2" is "trep", "right" and "2", "L1" is one word.
std::vector<std::u32string> words_of(const std::string& name) {
    std::vector<std::u32string> words(1);
    char32_t before = ' ';
    for (const char32_t c : decoded(name)) {
        const bool of_word = is_letter(c) || is_digit(c);
        const bool other =
            (is_capital(c) && is_letter(before) && !is_capital(before)) ||
            (is_digit(c) != is_digit(before) && is_letter(is_digit(c) ? before : c) && words.back().size() > 2);
        if ((!of_word || other) && !words.back().empty()) words.emplace_back();
        if (of_word) words.back() += lowered(c);
        before = c;
    }
    if (words.back().empty()) words.pop_back();
    return words;
}

using Words = std::vector<std::u32string_view>;

/// What is said of one side.
struct SideWords {
    Words words;   ///< anywhere
    Words ends;    ///< as the first or the last of several
    Words last;    ///< as the last of several: at the beginning it may be another word
    Words stems;   ///< of Slavonic adjectives, with an ending
    Words within;  ///< of scripts that put no space between words
};

const SideWords& words_for(Side side) {
    static const SideWords kLeft{
        {U"left",     U"links",    U"linke",    U"linken",  U"linker",  U"linkes",    U"linkem",    U"sinister",
         U"sinistra", U"sinistro", U"sinistre", U"gauche",  U"gauches", U"izquierda", U"izquierdo", U"izq",
         U"esquerda", U"esquerdo", U"vänster",  U"vänstra", U"venstre", U"lewy",      U"lewa",      U"lewe",
         U"lewej",    U"levý",     U"levá",     U"levé",    U"vlevo",   U"слева",     U"влево",     U"налево",
         U"лев",      U"зліва",    U"يسار",     U"أيسر",    U"الأيسر",  U"اليسرى",    U"يسرى"},
        {U"l", U"lt"},
        {U"li", U"sin", U"sx", U"sol"},
        {U"лев", U"лів"},
        {U"左", U"왼쪽", U"좌측"}};
    static const SideWords kRight{
        {U"right",   U"rechts",  U"rechte", U"rechten", U"rechter", U"rechtes", U"rechtem", U"dexter",  U"dextra",
         U"dextro",  U"dext",    U"droit",  U"droite",  U"droits",  U"droites", U"derecha", U"derecho", U"dcha",
         U"direita", U"direito", U"destra", U"destro",  U"höger",   U"högra",   U"højre",   U"høyre",   U"prawy",
         U"prawa",   U"prawe",   U"prawej", U"pravý",   U"pravá",   U"pravé",   U"vpravo",  U"справа",  U"вправо",
         U"направо", U"прав",    U"يمين",   U"أيمن",    U"الأيمن",  U"اليمنى",  U"يمنى"},
        {U"r"},
        {U"re", U"rt", U"dx", U"dex", U"sağ"},
        {U"прав"},
        {U"右", U"오른쪽", U"우측"}};
    return side == Side::left ? kLeft : kRight;
}

bool is_one_of(const Words& words, std::u32string_view word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

bool is_adjective_of(const Words& stems, std::u32string_view word) {
    static const Words kEndings{U"ый",  U"ая", U"ое", U"ые", U"ой", U"ого", U"ому", U"ую", U"ым", U"ом", U"ых",
                                U"ыми", U"ий", U"а",  U"е",  U"і",  U"ої",  U"ою",  U"у",  U"им", U"их"};
    return std::any_of(stems.begin(), stems.end(), [&](std::u32string_view stem) {
        return word.starts_with(stem) && is_one_of(kEndings, word.substr(stem.size()));
    });
}

bool names(const std::vector<std::u32string>& words, Side side) {
    const SideWords& known = words_for(side);
    for (std::size_t i = 0; i < words.size(); ++i) {
        const std::u32string& word = words[i];
        const bool several = words.size() > 1, last = several && i + 1 == words.size(),
                   end = last || (several && i == 0);
        if (is_one_of(known.words, word) || is_adjective_of(known.stems, word) ||
            (end && is_one_of(known.ends, word)) || (last && is_one_of(known.last, word)) ||
            std::any_of(known.within.begin(), known.within.end(),
                        [&](std::u32string_view part) { return word.find(part) != std::u32string::npos; }))
            return true;
    }
    return false;
}

/// "Rt frontal": right; "RT plan" is of radiotherapy.
bool begins_with_rt(const std::string& name) {
    return name.starts_with("Rt ") || name.starts_with("Rt.") || name.starts_with("rt ") || name.starts_with("rt.");
}

}  // namespace

std::optional<Side> side_named(const std::string& name) {
    const auto words = words_of(name);
    const bool left = names(words, Side::left), right = names(words, Side::right) || begins_with_rt(name);
    if (left == right) return std::nullopt;
    return left ? Side::left : Side::right;
}

}  // namespace planlight
