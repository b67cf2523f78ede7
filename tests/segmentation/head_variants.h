#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planning_io/types/volume.h"

namespace planlight::test {

/// The same head as another scanner, export or table position would have given it. What is shown keeps its place in
/// ct, so that verdicts must stand.
struct HeadVariant {
    std::string name;
    Volume volume;
    bool cut = false;  ///< a part of the head was cut off: that must be said
};

/// Stored along other axes (permuted and flipped); on a grid that is turned by 25 degrees; with Rician noise of 2 % and
/// a coil's shading of 2:1 (not of a CT in HU); and without its crown, chin or face (45 mm of what lies over 1 % of the
/// contrast there).
std::vector<HeadVariant> variants_of(const Volume& volume);

/// A copy of a NIfTI file without a word in its header and with a name that says nothing, in `folder`; the path itself
/// where it is no NIfTI file.
std::filesystem::path without_words(const std::filesystem::path& path, const std::filesystem::path& folder);

}  // namespace planlight::test
