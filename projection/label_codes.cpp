#include "projection/label_codes.h"

#include <hb.h>

#include <set>

#include "projection/stroke_font.h"

namespace planlight {
namespace {

constexpr std::u32string_view kLikeLatin = U"АВЕКМНОРСТУХЅІЈΑΒΕΖΗΙΚΜΝΟΡΤΥΧ", kLatin = U"ABEKMHOPCTYXSIJABEZHIKMNOPTYX";
static_assert(kLikeLatin.size() == kLatin.size());

/// The capital that a letter is read as: Latin for those of Greek and Cyrillic that look the same.
char32_t read_as(char32_t code) {
    if (code >= 0xFF21 && code <= 0xFF5A) code -= 0xFEE0;  // wide forms of the East
    if (code >= U'a' && code <= U'z') return code - 0x20;
    if ((code >= 0x03B1 && code <= 0x03C9) || (code >= 0x0430 && code <= 0x044F)) code -= 0x20;
    if (code >= 0x0450 && code <= 0x045F) code -= 0x50;
    const auto at = kLikeLatin.find(code);
    return at == std::u32string_view::npos ? code : kLatin[at];
}

bool is_letter(char32_t code) {
    switch (hb_unicode_general_category(hb_unicode_funcs_get_default(), code)) {
        case HB_UNICODE_GENERAL_CATEGORY_UPPERCASE_LETTER:
        case HB_UNICODE_GENERAL_CATEGORY_LOWERCASE_LETTER:
        case HB_UNICODE_GENERAL_CATEGORY_TITLECASE_LETTER:
        case HB_UNICODE_GENERAL_CATEGORY_OTHER_LETTER:
            return true;
        default:
            return false;
    }
}

bool is_digit(char32_t code) {
    return code >= U'0' && code <= U'9';
}

/// Digits of other scripts, Roman and circled numerals, and those of Chinese.
bool is_other_numeral(char32_t code) {
    constexpr std::u32string_view kOfTheEast = U"〇一二三四五六七八九十百";
    if (kOfTheEast.find(code) != std::u32string_view::npos) return true;
    switch (hb_unicode_general_category(hb_unicode_funcs_get_default(), code)) {
        case HB_UNICODE_GENERAL_CATEGORY_DECIMAL_NUMBER:
        case HB_UNICODE_GENERAL_CATEGORY_LETTER_NUMBER:
        case HB_UNICODE_GENERAL_CATEGORY_OTHER_NUMBER:
            return !is_digit(code);
        default:
            return false;
    }
}

/// What a name holds that a code could be taken for.
struct Tokens {
    std::set<std::u32string> numbers, words;
    bool other_numerals = false;

    void add(const std::string& name) {
        const std::u32string text = code_points(name);
        for (std::size_t i = 0; i < text.size();) {
            std::u32string token;
            const std::size_t from = i;
            if (is_digit(text[i])) {
                while (i < text.size() && is_digit(text[i])) token += text[i++];
                token.erase(0, std::min(token.find_first_not_of(U'0'), token.size()));
                numbers.insert(token);
            } else if (is_letter(text[i])) {
                while (i < text.size() && is_letter(text[i])) token += read_as(text[i++]);
                words.insert(token);
            } else {
                ++i;
            }
            for (std::size_t k = from; k < i; ++k) other_numerals |= is_other_numeral(text[k]);
        }
    }
};

std::string ascii(const std::u32string& token) {
    std::string text;
    for (const char32_t code : token) text += static_cast<char>(code);
    return text;
}

/// "A", "C", ... "AA": none that is read as a digit where pixels are coarse (B as 8, D and Q as 0, G as 6, J and L as
/// 1, S as 5, T as 7, Z as 2) or that stands for a Roman one alone.
std::vector<std::u32string> letter_codes() {
    constexpr std::u32string_view kClear = U"ACEFHKMNPRUWY";
    std::vector<std::u32string> codes;
    for (const char32_t a : kClear) codes.emplace_back(1, a);
    for (const char32_t a : kClear)
        for (const char32_t b : kClear) codes.push_back({a, b});
    return codes;
}

}  // namespace

std::vector<std::string> codes_of(const std::vector<std::string>& names, const std::vector<std::string>& lit) {
    std::vector<Tokens> of(names.size());
    std::set<std::u32string> words;
    bool numbers = true;
    for (std::size_t i = 0; i < names.size(); ++i) {
        of[i].add(names[i]);
        if (i < lit.size()) of[i].add(lit[i]);
        words.insert(of[i].words.begin(), of[i].words.end());
        numbers &= !of[i].other_numerals;
    }
    std::vector<std::string> codes;
    for (std::size_t i = 0; i < names.size() && numbers; ++i) {
        const std::string number = std::to_string(i + 1);
        for (std::size_t k = 0; k < names.size(); ++k)
            numbers &= k == i || !of[k].numbers.contains(std::u32string(number.begin(), number.end()));
        codes.push_back("#" + number);
    }
    if (numbers) return codes;
    codes.clear();
    for (const std::u32string& code : letter_codes())
        if (codes.size() < names.size() && !words.contains(code)) codes.push_back("#" + ascii(code));
    if (codes.size() < names.size()) codes.assign(names.size(), "");
    return codes;
}

}  // namespace planlight
