#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "tests/planning_io/synthetic_series.h"

namespace planlight::test {

/// A volume on disk, sound or spoilt in one way.
struct VolumeCase {
    std::string name;  ///< in words, for the table
    std::string says;  ///< a part of the refusal's sentence; empty: it is to be read
    std::function<std::filesystem::path(const std::filesystem::path& empty_folder)>
        make;            ///< what to give to read_volume
    std::string series;  ///< to ask for by name
    bool is_hu = true;
    std::string modality = "CT";
};

/// Everything that is to be read, with the phantom's values at their places: transfer syntaxes, positions, formats,
/// mixed folders.
std::vector<VolumeCase> sound_volumes();

/// Everything that is to be refused: DICOM series, then files of one volume.
std::vector<VolumeCase> spoilt_series();
std::vector<VolumeCase> spoilt_files();
inline std::vector<VolumeCase> spoilt_volumes() {
    std::vector<VolumeCase> list = spoilt_series();
    const std::vector<VolumeCase> files = spoilt_files();
    list.insert(list.end(), files.begin(), files.end());
    return list;
}

/// For a failed test's message.
inline void PrintTo(const VolumeCase& c, std::ostream* out) {
    *out << c.name;
}

/// Letters and digits of a case's name, for the name of a test.
std::string test_name_of(const VolumeCase& c);

}  // namespace planlight::test
