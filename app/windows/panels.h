#pragma once

#include "app/windows/operator_model.h"
#include "app/windows/pen.h"
#include "app/windows/status_word.h"

namespace planlight {

void draw_header(const Pen& pen, const WindowLayout& place, const OperatorModel& model);

/// The big status: word, shape, colour, sentences and figures. `notice`: why the last press did nothing; it stands
/// above the sentences for a while.
void draw_banner(const Pen& pen, const Box& box, const OperatorModel& model, const std::string& notice = {});

/// A camera's picture (the live one, or the refused one) with the found markers drawn over; one that is old is grey and
/// says its age. `texture` is null when there is no picture.
void draw_camera(const Pen& pen, const Box& box, const CameraPicture& camera, bool refused, ImTextureID texture);

/// The plan items from row `first_row` on, then as much of the evidence as there is room for; the `marked` row stands
/// out. Returns how many rows there was room for.
int draw_table(const Pen& pen, const Box& box, const OperatorModel& model, int first_row, bool hovered,
               std::optional<std::size_t> marked = {});

struct ButtonLook {
    bool chosen = false;    ///< it shows what is on, and looks held
    bool leads_on = false;  ///< it is what comes next, and stands out
    std::string key;        ///< shown in it
};

/// A button: drawn, and true when it was pressed and is enabled.
bool button(const Pen& pen, const Box& box, const std::string& label, const ButtonState& state,
            const ButtonLook& look = {});

/// The button that is always there and always works.
void draw_dark_button(const Pen& pen, const Box& box, bool hovered, bool held, const std::string& keys);

}  // namespace planlight
