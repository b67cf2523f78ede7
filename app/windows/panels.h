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

/// The worst of a row's risk structures is one that it goes through; it warns.
inline bool through_risk(const PlanRow& row) {
    return !row.risk.empty() && row.risk.front().through;
}
inline bool near_risk(const PlanRow& row) {
    return !row.risk.empty() && warns(row.risk.front());
}

/// Which rows of the table are seen, and which of them stands out.
struct TableView {
    int first_row = 0;                  ///< no later than what fills the table
    std::optional<std::size_t> marked;  ///< stands out
    bool seek = false;                  ///< it has just been marked: it is to be seen
};

/// The plan items, below an item how near it comes to a risk structure, then as much of the evidence as there is room
/// for. Returns the first row that is drawn.
int draw_table(const Pen& pen, const Box& box, const OperatorModel& model, const TableView& view, bool hovered);

/// So much room do the other columns leave for a name, pixels.
float table_name_width(const Pen& pen, const Box& box, const OperatorModel& model);

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
