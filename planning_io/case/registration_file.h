#pragma once

#include <filesystem>
#include <string>

#include "planning_io/types/registration_result.h"

namespace planlight {

/// registration.json, as `register` writes it and `project` reads it: with the names of case, rig and capture, the rig
/// as the scan found it, and a checksum. Throws DamagedFileError when the checksum is another; without one the verdict
/// `yes` is read as `ask`.
void write_registration(const RegistrationResult& result, const std::filesystem::path& file);

/// Throws DamagedFileError where the file's checksum does not fit, so that `ask` cannot become `yes` by an editor;
/// without a checksum a `yes` is read as `ask`.
RegistrationResult read_registration(const std::filesystem::path& file);

/// What `write_registration` writes, and what `read_registration` makes of it (`file`: for its words). The latter
/// throws as `read_registration` does: DamagedFileError for a checksum that does not fit or another version, InputError
/// for what is no registration.
std::string text_of(const RegistrationResult& result);
RegistrationResult registration_of_text(const std::string& text, const std::filesystem::path& file);

}  // namespace planlight
