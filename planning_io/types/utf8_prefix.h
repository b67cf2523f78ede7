#pragma once

#include <cstddef>
#include <string_view>

namespace planlight {

/// The beginning of a text in UTF-8, of at most so many bytes, with no letter cut in two; all of it where it is no
/// longer. Bytes that are no UTF-8 may be cut anywhere.
inline std::string_view utf8_prefix(std::string_view text, std::size_t most_bytes) {
    if (text.size() <= most_bytes) return text;
    std::size_t end = most_bytes;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
    return text.substr(0, end);
}

}  // namespace planlight
