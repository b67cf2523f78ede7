#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace planlight {

/// How many letters must be put in, taken out, exchanged, or swapped with their neighbour, to make one word of the
/// other (Damerau-Levenshtein, restricted). Upper case and "-" or " " for "_" are no difference.
std::size_t letters_apart(std::string_view a, std::string_view b);

/// The word that a mistyped one was meant to be: the nearest of `known`, the first of equals. Empty when none is alike:
/// more than a third of its letters (or, of a short word, more than one) would have to change.
std::optional<std::string> nearest_word(std::string_view mistyped, const std::vector<std::string>& known);

}  // namespace planlight
