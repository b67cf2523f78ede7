#pragma once

#include "app/windows/operator_model.h"
#include "app/windows/pen.h"

namespace planlight {

/// In the place of the 3-D view: every item of the plan with its whole name, and all that the match was judged by.
class EvidencePage {
public:
    /// True when it was closed.
    bool draw(const Pen& pen, const Box& place, const OperatorModel& model);

    Box close_button() const { return close_; }

private:
    float draw_items(const Pen& pen, Box box, const OperatorModel& model) const;
    float draw_sentences(const Pen& pen, Box box, const OperatorModel& model) const;

    Box close_{};
    float scrolled_ = 0, height_ = 0;  ///< pixels
};

}  // namespace planlight
