#pragma once

#include <string>
#include <utility>
#include <vector>

#include "planning_io/files/xml_text.h"
#include "planning_io/types/image.h"

namespace planlight {

struct Case;

/// A picture of a report with what it shows.
struct ReportPicture {
    std::string title, caption;
    RgbImage picture;
};

/// What stands under the heading of a page: name and value ("Case", "1f3c"; "Rig", ...). The operator (where none is
/// given the user who is logged in), the date and the program's version are added by `html_page`.
using ReportFacts = std::vector<std::pair<std::string, std::string>>;

/// The name of the user who is logged in, as the system has it.
std::string operator_name();

/// Case, patient, volume and plan by their names.
ReportFacts facts_of(const Case& the_case);

/// The picture as the address of an <img>: PNG inside the page.
std::string embedded_png(const RgbImage& picture);

/// The pictures as figures in rows of `columns` (0: two), inside the page as PNG or, where that is smaller, JPEG. With
/// two columns a picture more than twice as wide as high has a row of its own, and so has the last of an odd number: no
/// place stays empty.
std::string html_figures(const std::vector<ReportPicture>& pictures, int columns = 0);

/// One self-contained page, black on white for screen and paper, no network. `body` is what stands under the heading.
std::string html_page(const std::string& title, const std::string& body, const ReportFacts& facts = {});

}  // namespace planlight
