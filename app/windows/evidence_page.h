#pragma once

#include <map>
#include <optional>
#include <string>

#include "app/windows/operator_model.h"
#include "app/windows/pen.h"

namespace planlight {

/// In the place of the 3-D view: every item of the plan with its whole name, and all that the match was judged by.
class EvidencePage {
public:
    struct Pressed {
        bool close = false;
        std::optional<std::size_t> item;  ///< its row: it alone is to be bright, or no longer
    };
    Pressed draw(const Pen& pen, const Box& place, const OperatorModel& model);

    /// "close", and "item-1" and so on of those that are seen whole.
    const std::map<std::string, Box>& places() const { return places_; }

private:
    float draw_items(const Pen& pen, Box box, const Box& seen, const OperatorModel& model, Pressed& pressed);
    void take_drag(const Box& words);
    float draw_sentences(const Pen& pen, Box box, const OperatorModel& model) const;

    std::map<std::string, Box> places_;
    float scrolled_ = 0, height_ = 0;  ///< pixels
};

}  // namespace planlight
