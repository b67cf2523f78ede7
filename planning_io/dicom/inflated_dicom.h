#pragma once

#include <filesystem>
#include <string>

namespace planlight {

/// Where to read the file from: itself or, when it is in the deflated transfer syntax, an inflated copy in this
/// process's memory (explicit little endian), which lives as long as the process. Throws DamagedFileError when it
/// cannot be inflated.
std::string inflated_dicom(const std::filesystem::path& file);

}  // namespace planlight
