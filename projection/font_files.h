#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace planlight {

/// A font on this computer whose letters are outlines.
struct FontFile {
    std::filesystem::path file;
    int index = 0;  ///< of the face in a collection
    std::string family;
};

/// The fonts with outlines that fontconfig finds, upright and of usual weight before others, first those that every
/// figure was measured with: DejaVu Sans, then WenQuanYi Micro Hei for what it lacks (Chinese, Japanese, Korean), then
/// what else the site installed. `PLANLIGHT_FONT`, where it is set, names a font file that comes before all. Empty
/// where there is no such font.
std::vector<FontFile> font_files();

}  // namespace planlight
