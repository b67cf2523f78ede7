#include "planning_io/files/one_line.h"

#include <cstddef>

#include "planning_io/types/reading_direction.h"

namespace planlight {
namespace {

struct Sign {
    unsigned code;
    std::size_t bytes;
};

/// The sign that the text begins with; a byte that begins none counts as a sign of its own.
Sign first_sign(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned first = byte(0);
    const std::size_t bytes = first < 0x80 ? 1 : first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
    if (bytes <= 1 || bytes > text.size()) return {first, 1};
    unsigned code = first & (0xFFU >> (bytes + 1));
    for (std::size_t i = 1; i < bytes; ++i) {
        if ((byte(i) & 0xC0U) != 0x80U) return {first, 1};
        code = code << 6U | (byte(i) & 0x3FU);
    }
    return {code, bytes};
}

/// Control characters of ASCII and of Latin-1, separators of lines and paragraphs.
bool ends_a_line(unsigned code) {
    return code < 0x20 || (code >= 0x7F && code <= 0x9F) || code == 0x2028 || code == 0x2029;
}

}  // namespace

std::string on_one_line(std::string_view name) {
    std::string line;
    while (!name.empty()) {
        const auto [code, bytes] = first_sign(name);
        if (ends_a_line(code)) {
            if (!line.empty() && line.back() != ' ') line += ' ';
        } else if (!orders_direction(code)) {
            line += name.substr(0, bytes);
        }
        name.remove_prefix(bytes);
    }
    while (line.ends_with(' ')) line.pop_back();
    return line;
}

}  // namespace planlight
