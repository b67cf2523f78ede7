#pragma once

#include <string>
#include <vector>

namespace planlight {

/// Signs that have no ink of their own: joiners, marks of direction, variants.
bool has_no_ink(char32_t code);

bool is_control(char32_t code);

/// With U+200E, which has no ink, before and behind each figure with its sign and unit: beside a Hebrew or Arabic name
/// "12.5 mm" would else change places with the name, or with its own unit. A digit that belongs to a word is left to
/// it.
std::u32string mark_figures(const std::u32string& text);

/// A damaged byte, or a sign that means something else in every font.
bool is_no_letter(char32_t code);

/// Where each reader's sign begins, and the end: a letter with its accents is one sign.
std::vector<std::size_t> clusters_of(const std::u32string& text);

/// The text cut where a reader sees one sign end.
std::vector<std::string> readers_signs(const std::string& utf8);

/// UTF-8 of one code point.
std::string utf8_of(char32_t code);

}  // namespace planlight
