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

/// What a page says before all else, in a frame of its own: a shape, a sentence, and the reasons, each a sentence.
struct PageVerdict {
    enum class Kind { good, look, stop };
    Kind kind = Kind::good;
    std::string words;  ///< empty: the page judges nothing
    std::vector<std::string> reasons;
};

/// What stands under the verdict of a page: name and value ("Case", "1f3c"; "Rig", ...). The operator (where none is
/// given the user who is logged in), the program's version and when it was made are added by `html_page`.
using ReportFacts = std::vector<std::pair<std::string, std::string>>;

/// The facts with those three where they lack them.
ReportFacts with_program(ReportFacts facts);

/// The signs of the verdict's shape: "✓", "⚠", "✗".
const char* sign_of(PageVerdict::Kind kind);

/// The verdict with its reasons as a list, for a page made of sheets.
std::string verdict_as_list(const PageVerdict& verdict);

/// The name of the user who is logged in, as the system has it.
std::string operator_name();

/// Case, patient, volume and plan by their names.
ReportFacts facts_of(const Case& the_case);

/// The picture as the address of an <img>: PNG inside the page.
std::string embedded_png(const RgbImage& picture);

/// The same, as JPEG where that is smaller and the picture need not be `exact`.
std::string embedded_picture(const RgbImage& picture, bool exact = false);

/// The bytes of a JPEG file; empty where a PNG file is no larger. Drawings are sharp and small as PNG, scenes and
/// photographs as JPEG.
std::string smaller_jpeg(const RgbImage& picture);

/// Lines to be signed, one for each of those people ("Read and accepted by").
std::string lines_to_sign(const std::vector<std::string>& who);

/// "Planlight 1.2".
std::string program_name();

/// One self-contained page, black on white for screen and paper (A4 and Letter), no network: verdict, facts, `body`,
/// and lines to be signed by `signed_by`.
std::string html_page(const std::string& title, const PageVerdict& verdict, const ReportFacts& facts,
                      const std::string& body, const std::vector<std::string>& signed_by = {});

}  // namespace planlight
