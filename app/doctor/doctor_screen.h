#pragma once

#include <string>

#include "app/doctor/running_examination.h"
#include "app/windows/doctor_page_model.h"

namespace planlight {

/// What the window shows of an examination; `room`: how room.json calls the room.
DoctorPageModel doctor_page_model_of(const ExaminationState& state, const std::string& room);

}  // namespace planlight
