#pragma once

namespace planlight {

/// Orders a direction of reading other than the letters' own: "B", U+202E, "12" would be lit as "B21", and "5 mm 9 mm"
/// with U+200F as "9 mm 5 mm".
constexpr bool orders_direction(char32_t code) {
    return code == 0x061C || code == 0x200E || code == 0x200F || (code >= 0x202A && code <= 0x202E) ||
           (code >= 0x2066 && code <= 0x2069);
}

}  // namespace planlight
