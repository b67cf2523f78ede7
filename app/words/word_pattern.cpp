#include "app/words/word_pattern.h"

#include <algorithm>
#include <cctype>
#include <stdexcept>

namespace planlight {
namespace {

/// How many characters of a number begin at `at`: "-1.5", "12", "inf"; 0: none does.
std::size_t number_length(const std::string& text, std::size_t at) {
    const auto digit = [&](std::size_t i) {
        return i < text.size() && std::isdigit(static_cast<unsigned char>(text[i]));
    };
    std::size_t end = at;
    if (end < text.size() && (text[end] == '-' || text[end] == '+')) ++end;
    for (const char* word : {"inf", "nan"})
        if (text.compare(end, 3, word) == 0) return end + 3 - at;
    if (!digit(end)) return 0;
    while (digit(end)) ++end;
    if (end < text.size() && text[end] == '.' && digit(end + 1)) {
        ++end;
        while (digit(end)) ++end;
    }
    return end - at;
}

}  // namespace

WordPattern::Kind WordPattern::kind_of(const std::string& place) {
    if (place.starts_with("name")) return Kind::name;
    return place.starts_with("words") ? Kind::words : Kind::number;
}

WordPattern::WordPattern(const std::string& text) {
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t open = text.find_first_of("{}", at), end = std::min(open, text.size());
        if (end > at) pieces_.push_back({Kind::literal, text.substr(at, end - at)});
        if (open == std::string::npos) break;
        const std::size_t close = text.find_first_of("{}", open + 1);
        if (text[open] == '}' || close == std::string::npos || text[close] == '{' || close == open + 1)
            throw std::invalid_argument("a bracket without its partner");
        const std::string place = text.substr(open + 1, close - open - 1);
        pieces_.push_back({kind_of(place), place});
        at = close + 1;
    }
}

bool WordPattern::match_from(std::size_t piece, const std::string& text, std::size_t at, const Judge& accepts,
                             Values& values) const {
    if (piece == pieces_.size()) return at == text.size();
    const Piece& p = pieces_[piece];
    if (p.kind == Kind::literal)
        return text.compare(at, p.text.size(), p.text) == 0 &&
               match_from(piece + 1, text, at + p.text.size(), accepts, values);
    if (p.kind == Kind::number) {
        const std::size_t length = number_length(text, at);
        values[p.text] = text.substr(at, length);
        return length > 0 && match_from(piece + 1, text, at + length, accepts, values);
    }
    const bool last = piece + 1 == pieces_.size();
    const std::string& next = last ? std::string{} : pieces_[piece + 1].text;
    const bool before_literal = !last && pieces_[piece + 1].kind == Kind::literal;
    for (std::size_t end = at + 1; end <= text.size(); ++end) {
        if (last) end = text.size();
        if (before_literal) end = text.find(next, end);
        if (end == std::string::npos || end <= at) return false;
        const std::string inside = text.substr(at, end - at);
        if ((p.kind == Kind::name || accepts(inside)) && match_from(piece + 1, text, end, accepts, values)) {
            values[p.text] = inside;
            return true;
        }
    }
    return false;
}

std::optional<WordPattern::Values> WordPattern::match(const std::string& text, const Judge& accepts) const {
    Values values;
    if (!match_from(0, text, 0, accepts, values)) return std::nullopt;
    return values;
}

std::string WordPattern::filled(const Values& values) const {
    std::string text;
    for (const Piece& p : pieces_) {
        if (p.kind == Kind::literal)
            text += p.text;
        else if (const auto value = values.find(p.text); value != values.end())
            text += value->second;
    }
    return text;
}

std::vector<std::string> WordPattern::places() const {
    std::vector<std::string> names;
    for (const Piece& p : pieces_)
        if (p.kind != Kind::literal) names.push_back(p.text);
    std::sort(names.begin(), names.end());
    return names;
}

std::size_t WordPattern::own_letters() const {
    std::size_t letters = 0;
    for (const Piece& p : pieces_)
        if (p.kind == Kind::literal) letters += p.text.size();
    return letters;
}

}  // namespace planlight
