#pragma once

#include <imgui.h>

#include <set>
#include <string>
#include <vector>

#include "app/windows/fonts.h"
#include "app/windows/layout.h"
#include "app/words/words.h"
#include "planning_io/types/image.h"

namespace planlight {

/// The colours of the dark theme.
namespace theme {
constexpr ImU32 kBackground = IM_COL32(11, 13, 17, 255), kPanel = IM_COL32(18, 21, 28, 255),
                kEdge = IM_COL32(38, 44, 56, 255), kText = IM_COL32(232, 236, 242, 255),
                kQuiet = IM_COL32(150, 160, 176, 255), kGreen = IM_COL32(56, 214, 132, 255),
                kAmber = IM_COL32(250, 184, 40, 255), kRed = IM_COL32(255, 92, 92, 255),
                kBlue = IM_COL32(72, 150, 240, 255), kActive = IM_COL32(32, 82, 132, 255),
                kControl = IM_COL32(38, 46, 60, 255), kHovered = IM_COL32(52, 64, 84, 255);
}  // namespace theme

/// Draws text and shapes so that nothing leaves its place: text that is too long is broken, then ended with "…". What
/// it is given is drawn as it is: texts of the program come through `say`, names do not.
struct Pen {
    ImDrawList* list;
    FontSet fonts;
    float scale;
    const Words* words = nullptr;           ///< null: English
    std::set<unsigned>* lacking = nullptr;  ///< takes the letters that its fonts do not have; may be null

    enum class Side { left, centre, right };

    std::vector<std::string>* cut = nullptr;  ///< takes the texts that had no room; may be null

    /// In the window's language.
    std::string say(const std::string& english) const { return words ? words->say(english) : english; }

    void panel(const Box& box, ImU32 fill = theme::kPanel, ImU32 edge = theme::kEdge, float edge_width = 1) const;
    /// One line, its middle at `middle_y`; ends with "…" when wider than `width` (0: as wide as it is).
    void line(const ImFont* font, const std::string& text, float x, float middle_y, float width, ImU32 colour,
              Side side = Side::left) const;
    /// Broken lines from the top of the box, as many as fit; returns the height used.
    float paragraph(const ImFont* font, const std::string& text, const Box& box, ImU32 colour,
                    Side side = Side::left) const;

    void tick(ImVec2 middle, float size, ImU32 colour) const;
    void triangle(ImVec2 middle, float radius, ImU32 colour) const;
    void polygon(ImVec2 middle, float radius, int corners, float turn, ImU32 colour) const;
};

float text_width(const ImFont* font, const std::string& text);
float line_height(const ImFont* font);

/// The text broken at spaces into lines no wider than `width`, at most `most` of them; what is left out is marked "…".
std::vector<std::string> broken(const ImFont* font, const std::string& text, float width, std::size_t most);

/// One line no wider than `width`: what stands in the middle gives way to "…", so that a name is known by its
/// beginning, and its figures at the end are read.
std::string shortened_in_the_middle(const ImFont* font, const std::string& text, float width);

ImU32 colour_of(const Rgb& colour);

}  // namespace planlight
