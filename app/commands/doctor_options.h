#pragma once

#include <filesystem>
#include <string>

#include "app/doctor/running_examination.h"

namespace planlight {

/// What `planlight doctor` was asked for.
struct DoctorOptions {
    std::filesystem::path room, case_folder;
    bool json = false;
    bool window = false;  ///< on the page of a window
    std::string operator_monitor, language, theme;
    std::filesystem::path screenshot;  ///< of that page when all was looked at, and then it ends; empty: none
};

/// Shows it on a page, as often as the person looks again. What was found last when the page is closed; of an
/// examination that goes on then, what there is.
ExaminationState show_doctor_page(const DoctorOptions& options, const RoomFile& room);

}  // namespace planlight
