#pragma once

#include <string>

namespace planlight {

/// One self-contained page, black on white, made to be printed on A4 or Letter, no network. Sections of the class
/// "sheet" begin a sheet of paper each; `foot` (plain text) stands at the foot of every sheet.
std::string paper_page(const std::string& title, const std::string& body, const std::string& foot);

}  // namespace planlight
