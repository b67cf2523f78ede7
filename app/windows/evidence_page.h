#pragma once

#include <map>
#include <optional>
#include <string>

#include "app/windows/operator_model.h"
#include "app/windows/panels.h"
#include "app/windows/pen.h"

namespace planlight {

/// In the place of the 3-D view: every item of the plan with its whole name, and all that the match was judged by.
class EvidencePage {
public:
    struct Pressed {
        bool close = false;
        std::optional<std::size_t> item;    ///< its row: it alone is to be bright, or no longer
        std::optional<std::size_t> hidden;  ///< its row: it is to be hidden, or shown again
    };
    /// `marked`: a row that stands out, for keys; it is brought into sight when another one is marked.
    Pressed draw(const Pen& pen, const Box& place, const OperatorModel& model, std::optional<std::size_t> marked);

    /// "close", and "item-1", "hide-1" and so on of those that are seen whole.
    const std::map<std::string, Box>& places() const { return places_; }

private:
    float draw_items(const Pen& pen, Box box, const Box& seen, const OperatorModel& model, Pressed& pressed);
    bool item_button(const Pen& pen, const Box& at, const Box& seen, const std::string& label, const ButtonState& state,
                     const ButtonLook& look, const std::string& place);
    void bring_into_sight(const Box& words);
    void take_drag(const Box& words);
    float draw_sentences(const Pen& pen, Box box, const OperatorModel& model) const;

    std::map<std::string, Box> places_;
    float scrolled_ = 0, height_ = 0;  ///< pixels
    std::optional<std::size_t> marked_;
    Box marked_at_;  ///< in the last frame
    bool new_mark_ = false;
};

}  // namespace planlight
