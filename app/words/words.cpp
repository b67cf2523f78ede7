#include "app/words/words.h"

#include <algorithm>
#include <cctype>

namespace planlight {
namespace {

constexpr int kDeepest = 6;  // a sentence in a sentence
constexpr std::size_t kRemembered = 4000;
constexpr std::size_t kEnoughOwn = 6;  // bytes of its own that a pattern must have to be used on a part that is English

bool has_letter(const std::string& text) {
    return std::any_of(text.begin(), text.end(), [](unsigned char c) { return std::isalpha(c) || c >= 0x80; });
}

/// The same with its first letter as a capital, or small: Latin with accents and Cyrillic, UTF-8.
std::string with_first(std::string text, bool capital) {
    if (text.empty()) return text;
    const auto first = static_cast<unsigned char>(text[0]);
    if (first < 0x80) {
        text[0] = static_cast<char>(capital ? std::toupper(first) : std::tolower(first));
        return text;
    }
    if (text.size() < 2) return text;
    int code = (first & 0x1F) << 6 | (static_cast<unsigned char>(text[1]) & 0x3F);
    const bool two_bytes = (first & 0xE0) == 0xC0;
    if (capital && ((code >= 0xE0 && code <= 0xFE) || (code >= 0x430 && code <= 0x44F))) code -= 0x20;
    if (!capital && ((code >= 0xC0 && code <= 0xDE) || (code >= 0x410 && code <= 0x42F))) code += 0x20;
    if (!two_bytes) return text;
    text[0] = static_cast<char>(0xC0 | code >> 6);
    text[1] = static_cast<char>(0x80 | (code & 0x3F));
    return text;
}

bool is_upper(const std::string& text) {
    return !text.empty() && std::isupper(static_cast<unsigned char>(text[0])) != 0;
}

/// Where the next part begins after `between`, which must be followed by what can begin one; not within brackets.
std::size_t next_part(const std::string& text, const std::string& between, std::size_t from) {
    for (std::size_t at = text.find(between, from); at != std::string::npos; at = text.find(between, at + 1)) {
        const std::size_t then = at + between.size();
        if (then >= text.size()) return std::string::npos;
        const auto before = text.begin() + static_cast<std::ptrdiff_t>(at);
        if (std::count(text.begin(), before, '(') > std::count(text.begin(), before, ')')) continue;
        const auto c = static_cast<unsigned char>(text[then]);
        if (between != ". " || std::isupper(c) || c == '"' || c == '`') return at;
    }
    return std::string::npos;
}

}  // namespace

Words::Words(const Language& language) : code_(language.code) {
    for (const auto& [english, own] : language.words) {
        letters_ += own;
        WordPattern pattern(english);
        if (pattern.has_places())
            patterns_.push_back({std::move(pattern), WordPattern(own)});
        else
            plain_[english] = own;
    }
    std::stable_sort(patterns_.begin(), patterns_.end(),
                     [](const Entry& a, const Entry& b) { return a.english.own_letters() > b.english.own_letters(); });
}

std::string Words::say(const std::string& english) const {
    return code_ == "en" || english.empty() ? english : said(english, 0).text;
}

bool Words::knows(const std::string& english) const {
    return code_ == "en" || english.empty() || said(english, 0).whole;
}

Words::Said Words::by_pattern(const std::string& english, bool strict, int depth) const {
    for (const Entry& entry : patterns_) {
        if (!strict && entry.english.own_letters() < kEnoughOwn) break;
        auto values = entry.english.match(
            english, [&](const std::string& words) { return !strict || said(words, depth + 1).whole; });
        if (!values) continue;
        bool whole = true;
        for (auto& [place, value] : *values) {
            if (WordPattern::kind_of(place) != WordPattern::Kind::words) continue;
            const Said inside = said(value, depth + 1);
            value = inside.text;
            whole = whole && inside.whole;
        }
        return {entry.own.filled(*values), whole};
    }
    return {english, false};
}

Words::Said Words::by_entry(const std::string& english, int depth) const {
    if (const auto found = plain_.find(english); found != plain_.end()) return {found->second, true};
    return by_pattern(english, true, depth);
}

/// Part by part, where at least one of them is known.
Words::Said Words::by_parts(const std::string& english, const std::string& between, int depth) const {
    const std::size_t at = next_part(english, between, 0);
    if (at == std::string::npos) return {english, false};
    const std::size_t cut = between == ". " ? at + 1 : at;  // the full stop belongs to its sentence
    const Said first = said(english.substr(0, cut), depth + 1),
               rest = said(english.substr(at + between.size()), depth + 1);
    const std::string joint = between == ". " ? " " : between;
    return {first.text + joint + rest.text, first.whole && rest.whole};
}

Words::Said Words::said(const std::string& english, int depth) const {
    if (!has_letter(english)) return {english, true};
    if (depth > kDeepest) return {english, false};
    if (const auto known = before_.find(english); known != before_.end()) return known->second;
    Said found = by_entry(english, depth);
    if (!found.whole && english.ends_with('.')) {
        found = by_entry(english.substr(0, english.size() - 1), depth);
        if (found.whole) found.text += ".";
    }
    if (!found.whole) {
        const bool capital = is_upper(english);
        const std::string other = with_first(english, !capital);
        if (other != english) found = by_entry(other, depth);
        if (!found.whole && other.ends_with('.')) {
            found = by_entry(other.substr(0, other.size() - 1), depth);
            if (found.whole) found.text += ".";
        }
        if (found.whole && capital) found.text = with_first(found.text, true);
    }
    for (const char* between : {". ", ": ", "; ", ", ", " · "}) {
        if (found.whole) break;
        found = by_parts(english, between, depth);
    }
    if (!found.whole) found = by_pattern(english, false, depth);
    for (const char* between : {". ", ": ", "; "}) {
        if (found.whole || found.text != english) break;
        found = by_parts(english, between, depth);
    }
    if (before_.size() > kRemembered) before_.clear();
    before_[english] = found;
    return found;
}

std::shared_ptr<const Words> words_of(const std::string& code) {
    return code == "en" ? std::make_shared<const Words>() : std::make_shared<const Words>(language_of(code));
}

}  // namespace planlight
