#pragma once

#include <string>

namespace planlight {

/// Text as it may stand in XML or HTML, in an attribute as well; control signs, which XML forbids, become blanks.
std::string xml_escaped(const std::string& text);

}  // namespace planlight
