#include "app/without_numbers.h"

#include <cctype>

namespace planlight {

std::string without_numbers(const std::string& text) {
    const auto digit = [&](std::size_t i) {
        return i < text.size() && std::isdigit(static_cast<unsigned char>(text[i])) != 0;
    };
    std::string out;
    for (std::size_t i = 0; i < text.size();) {
        if (!digit(i)) {
            out += text[i++];
            continue;
        }
        while (digit(i) || (i < text.size() && text[i] == '.' && digit(i + 1))) ++i;
        out += "…";
    }
    return out;
}

}  // namespace planlight
