#pragma once

#include <filesystem>

#include "planning_io/types/registration_result.h"

namespace planlight {

/// registration.json, as `register` writes it and `project` reads it.
void write_registration(const RegistrationResult& result, const std::filesystem::path& file);
RegistrationResult read_registration(const std::filesystem::path& file);

}  // namespace planlight
