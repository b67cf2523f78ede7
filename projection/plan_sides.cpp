#include "projection/plan_sides.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <vector>

namespace planlight {
namespace {

std::vector<std::string> words_of(const std::string& name) {
    std::vector<std::string> words(1);
    for (const char c : name) {
        if (std::isalnum(static_cast<unsigned char>(c)) || (c & 0x80))
            words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        else if (!words.back().empty())
            words.emplace_back();
    }
    if (words.back().empty()) words.pop_back();
    return words;
}

}  // namespace

std::optional<Side> side_named(const std::string& name) {
    static constexpr std::array kLeft{"left",     "links",    "linke",  "linker",   "linkes",
                                      "sinister", "sinistra", "gauche", "izquierda"};
    static constexpr std::array kRight{"right",  "rechts", "rechte", "rechter", "rechtes",
                                       "dexter", "dextra", "droit",  "droite",  "derecha"};
    const auto words = words_of(name);
    bool left = false, right = false;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const bool at_end = i == 0 || i + 1 == words.size();
        left = left || std::find(kLeft.begin(), kLeft.end(), words[i]) != kLeft.end() ||
               (at_end && words.size() > 1 && words[i] == "l");
        right = right || std::find(kRight.begin(), kRight.end(), words[i]) != kRight.end() ||
                (at_end && words.size() > 1 && words[i] == "r");
    }
    if (left == right) return std::nullopt;
    return left ? Side::left : Side::right;
}

}  // namespace planlight
