#pragma once

#include "app/windows/operator_model.h"
#include "app/windows/pen.h"

namespace planlight {

void draw_header(const Pen& pen, const WindowLayout& place, const OperatorModel& model);

/// The big status: word, shape, colour, sentences and figures.
void draw_banner(const Pen& pen, const Box& box, const OperatorModel& model);

/// A camera's picture with the found markers drawn over; `texture` is null when there is no picture.
void draw_camera(const Pen& pen, const Box& box, const CameraPicture& camera, ImTextureID texture);

struct TableShown {
    int rows = 1;              ///< there was room for
    bool all_evidence = true;  ///< false: some sentences were cut for want of room
};

/// The plan items from row `first_row` on, then the evidence.
TableShown draw_table(const Pen& pen, const Box& box, const OperatorModel& model, int first_row);

/// A button: drawn, and true when it was pressed and is enabled. `chosen`: it shows what is on, and looks held.
bool button(const Pen& pen, const Box& box, const std::string& label, const ButtonState& state, bool chosen = false);

/// The button that is always there and always works.
void draw_dark_button(const Pen& pen, const Box& box, bool hovered, bool held);

/// The word of a status: "ALIGNED".
const char* status_word(StatusKind kind);

}  // namespace planlight
