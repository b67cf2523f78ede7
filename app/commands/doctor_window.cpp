#include "app/commands/doctor_options.h"
#include "app/commands/language_option.h"
#include "app/console.h"
#include "app/doctor/doctor_screen.h"
#include "app/windows/doctor_page.h"
#include "planning_io/files/image_file.h"

namespace planlight {
ExaminationState show_doctor_page(const DoctorOptions& options, const RoomFile& room) {
    constexpr double kLongestRest_s = 0.05;
    note_end_signals();
    DoctorPage page(settings_of_page("Planlight doctor", options.language, options.theme, options.operator_monitor));
    ExamineSettings examine;
    examine.case_folder = options.case_folder;
    auto examination = std::make_unique<RunningExamination>(room, examine);
    for (;;) {
        examination->answer();
        const ExaminationState state = examination->state();
        const DoctorPageAction action = page.frame(doctor_page_model_of(state, room.name));
        if (action == DoctorPageAction::dark) examination->end();
        if (action == DoctorPageAction::again && state.over)
            examination = std::make_unique<RunningExamination>(room, examine);
        if (action == DoctorPageAction::quit || asked_to_end()) break;
        if (state.over && !options.screenshot.empty()) {
            write_png(page.screenshot(), options.screenshot, ReadableBy::owner);
            break;
        }
        page.rest(kLongestRest_s);
    }
    examination->end();
    return examination->state();
}

}  // namespace planlight
