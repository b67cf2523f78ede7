#pragma once

#include "app/windows/doctor_page_model.h"
#include "app/windows/pen.h"

namespace planlight {

/// Where everything stands on the page.
struct DoctorPageLayout {
    Box title, banner;
    Box wanted, good;  ///< the lines that want a person, and those that are good
    Box dark, again, close;
};
DoctorPageLayout doctor_page_layout(float width, float height, float scale);

/// How many lines are left out above, in each panel; drawing takes back what would leave room unused.
struct DoctorPageScroll {
    int wanted = 0, good = 0;
};

/// The word of the whole, readable from afar, and what it means.
void draw_doctor_verdict(const Pen& pen, const Box& box, const DoctorPageModel& model);

/// What wants a person, what must not be used like this first: word, what was found, what to do.
void draw_wanted_lines(const Pen& pen, const Box& box, const DoctorPageModel& model, int& scroll);

/// What is good, a row each.
void draw_good_lines(const Pen& pen, const Box& box, const DoctorPageModel& model, int& scroll);

/// All of it; what was pressed, but DARK.
DoctorPageAction draw_doctor_page(const Pen& pen, const DoctorPageLayout& place, const DoctorPageModel& model,
                                  DoctorPageScroll& scroll);

}  // namespace planlight
