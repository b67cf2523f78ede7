#pragma once

#include <imgui.h>

#include <set>
#include <string>
#include <vector>

#include "app/windows/fonts.h"
#include "app/windows/layout.h"
#include "app/windows/theme.h"
#include "app/words/words.h"
#include "planning_io/types/image.h"

namespace planlight {

/// Draws text and shapes so that nothing leaves its place: text that is too long is broken, then ended with "…". What
/// it is given is drawn as it is: texts of the program come through `say`, names do not.
struct Pen {
    ImDrawList* list;
    FontSet fonts;
    float scale;
    const Words* words = nullptr;  ///< null: English
    const Theme* theme = &theme_of(ThemeKind::dark);
    std::set<unsigned>* lacking = nullptr;  ///< takes the letters that its fonts do not have; may be null

    enum class Side { left, centre, right };

    std::vector<std::string>* cut = nullptr;  ///< takes the texts that had no room; may be null

    /// In the window's language.
    std::string say(const std::string& english) const { return words ? words->say(english) : english; }

    void panel(const Box& box) const { panel(box, theme->panel, theme->edge); }
    void panel(const Box& box, ImU32 fill) const { panel(box, fill, theme->edge); }
    void panel(const Box& box, ImU32 fill, ImU32 edge, float edge_width = 1) const;
    /// One line, its middle at `middle_y`; ends with "…" when wider than `width` (0: as wide as it is).
    void line(const ImFont* font, const std::string& text, float x, float middle_y, float width, ImU32 colour,
              Side side = Side::left) const;
    /// Broken lines from the top of the box, as many as fit; returns the height used.
    float paragraph(const ImFont* font, const std::string& text, const Box& box, ImU32 colour,
                    Side side = Side::left) const;

    /// An item's own colour.
    void swatch(const Box& box, const Rgb& colour) const;
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
