#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "planning_io/types/image.h"

namespace planlight {

/// A picture of a report with what it shows.
struct ReportPicture {
    std::string title, caption;
    RgbImage picture;
};

/// What stands under the heading of every page: name and value ("Case", "1f3c"; "Rig", ...). A date, the operator (the
/// user who is logged in) and the program's version are added by `html_page`.
using ReportFacts = std::vector<std::pair<std::string, std::string>>;

struct Case;
/// Case, its volume, and its plan by the names of its items.
ReportFacts facts_of(const Case& the_case);

/// Text with & < > " made safe for a page.
std::string html_escaped(const std::string& text);

/// The pictures as figures in rows of `columns` (0: two), inside the page: a picture more than twice as wide as high
/// has a row of its own, and so has the last of an odd number, so that no place stays empty. Photographs and scenes are
/// compressed (JPEG) where that makes them smaller. `scratch` is not used any more.
std::string html_figures(const std::vector<ReportPicture>& pictures, const std::filesystem::path& scratch,
                         int columns = 0);

/// One self-contained page, black on white for screen and paper, no network. `body` is what stands under the heading.
std::string html_page(const std::string& title, const std::string& body, const ReportFacts& facts = {});

}  // namespace planlight
