#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string_view>

namespace planlight {

/// The two patient frames that planning programs write: LPS (ours, DICOM's) and RAS (turned by 180 degrees about z).
enum class Space { lps, ras };

/// Exactly "LPS" or "RAS"; empty for any other word.
std::optional<Space> space_named(std::string_view word);

/// What a header says by "SPACE=LPS" or "SPACE=RAS" (as 3D Slicer writes and reads it); empty when it says neither.
/// Throws InputError when it says both, or another word.
std::optional<Space> space_marked(std::string_view header, const std::filesystem::path& file);

/// The space of a file, from what it says itself and what a person says of it. Throws InputError when neither does
/// (`how_to_say` tells where the file would say it), or when the two differ. `option` is what the person says it by, as
/// in
/// "--frame"; empty where there is no such option.
Space settled_space(std::optional<Space> file_says, std::optional<Space> person_says, const std::filesystem::path& file,
                    std::string_view how_to_say, std::string_view option = "--frame");

/// `ct` is LPS, mm: a point in RAS has its first two numbers turned.
inline Eigen::Vector3d to_ct(const Eigen::Vector3d& p, Space space) {
    return space == Space::lps ? p : Eigen::Vector3d(-p.x(), -p.y(), p.z());
}

}  // namespace planlight
