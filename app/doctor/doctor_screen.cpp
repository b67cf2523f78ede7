#include "app/doctor/doctor_screen.h"

namespace planlight {
namespace {

using Page = DoctorPageModel;

Page::Health health_of(Health health) {
    return health == Health::good   ? Page::Health::good
           : health == Health::look ? Page::Health::look
                                    : Page::Health::stop;
}

/// What stops is said of the whole even when somebody ended it before all was looked at.
Page::Verdict verdict_of(const ExaminationState& state) {
    if (!state.over) return Page::Verdict::looking;
    const Health worst = worst_of(state.lines);
    if (worst == Health::stop) return Page::Verdict::stop;
    if (state.ended_by_hand) return Page::Verdict::ended;
    return worst == Health::look ? Page::Verdict::look : Page::Verdict::good;
}

}  // namespace

DoctorPageModel doctor_page_model_of(const ExaminationState& state, const std::string& room) {
    Page model;
    model.title = "Is everything in this room ready for a patient?";
    model.subtitle = room;
    model.verdict = verdict_of(state);
    model.step = state.under_way;
    model.took_s = static_cast<int>(state.took_s);
    for (const DoctorLine& line : state.lines)
        model.lines.push_back({line.subject, health_of(line.health), line.said, line.remedy});
    return model;
}

}  // namespace planlight
