#include "planning_io/files/nearest_word.h"

#include <algorithm>
#include <cctype>

namespace planlight {
namespace {

std::string plain(std::string_view word) {
    std::string result(word);
    for (char& c : result)
        c = c == '-' || c == ' ' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return result;
}

}  // namespace

std::size_t letters_apart(std::string_view first, std::string_view second) {
    const std::string a = plain(first), b = plain(second);
    // rows of the table for the last two letters of `a` and the present one
    std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), now(b.size() + 1);
    for (std::size_t k = 0; k <= b.size(); ++k) now[k] = k;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        before.swap(last);
        last.swap(now);
        now[0] = i;
        for (std::size_t k = 1; k <= b.size(); ++k) {
            now[k] = std::min({last[k] + 1, now[k - 1] + 1, last[k - 1] + (a[i - 1] == b[k - 1] ? 0 : 1)});
            if (i > 1 && k > 1 && a[i - 1] == b[k - 2] && a[i - 2] == b[k - 1])
                now[k] = std::min(now[k], before[k - 2] + 1);
        }
    }
    return now[b.size()];
}

std::optional<std::string> nearest_word(std::string_view mistyped, const std::vector<std::string>& known) {
    const auto nearest = std::min_element(known.begin(), known.end(), [&](const auto& a, const auto& b) {
        return letters_apart(mistyped, a) < letters_apart(mistyped, b);
    });
    if (nearest == known.end()) return std::nullopt;
    const std::size_t most = std::max<std::size_t>(1, nearest->size() / 3);
    if (letters_apart(mistyped, *nearest) > most) return std::nullopt;
    return *nearest;
}

}  // namespace planlight
