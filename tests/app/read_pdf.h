#pragma once

#include <string>
#include <vector>

namespace planlight::test {

/// What a PDF of ours says, a text a sheet: its lines in the order in which they were written, one blank between them.
/// Letters that are drawn as outlines are not in it.
std::vector<std::string> sheets_of(const std::string& pdf);

/// All of its sheets as one text.
std::string text_of(const std::string& pdf);

}  // namespace planlight::test
