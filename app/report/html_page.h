#pragma once

#include <string>
#include <vector>

#include "planning_io/types/image.h"

namespace planlight {

/// A picture of a report with what it shows.
struct ReportPicture {
    std::string title, caption;
    RgbImage picture;
};

/// Text with & < > " made safe for a page.
std::string html_escaped(const std::string& text);

/// The picture as the address of an <img>: PNG inside the page.
std::string embedded_png(const RgbImage& picture);

/// The pictures as a grid of figures, PNG inside the page, `columns` a row (0 = as many as fit).
std::string html_figures(const std::vector<ReportPicture>& pictures, int columns = 0);

/// One self-contained page, dark, no network. `body` is what stands under the heading.
std::string html_page(const std::string& title, const std::string& body);

}  // namespace planlight
