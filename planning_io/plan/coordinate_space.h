#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace planlight {

/// The two patient frames that planning programs write: LPS (ours, DICOM's) and RAS (turned by 180 degrees about z).
enum class Space { lps, ras };

const char* name_of(Space space);

/// Exactly "LPS" or "RAS"; empty for any other word.
std::optional<Space> space_named(std::string_view word);

/// A frame that is named where it may mean something else.
struct SpaceMention {
    std::string word, line;
};

/// What a file says of its frame.
struct SpaceSaid {
    std::optional<Space> space;
    std::vector<SpaceMention> mentions = {};

    SpaceSaid() = default;
    SpaceSaid(std::optional<Space> said) : space(said) {}
};

/// The space of a file, from what it says itself and what a person says of it. Throws InputError when neither does
/// (`how_to_say` tells where the file would say it), when the two differ, or when a file that does not say its frame
/// mentions another than the person's. `option` is what the person says it by, as in "--frame"; empty where there is no
/// such option.
Space settled_space(const SpaceSaid& file_says, std::optional<Space> person_says, const std::filesystem::path& file,
                    std::string_view how_to_say, std::string_view option = "--frame");

/// `ct` is LPS, mm: a point in RAS has its first two numbers turned.
inline Eigen::Vector3d to_ct(const Eigen::Vector3d& p, Space space) {
    return space == Space::lps ? p : Eigen::Vector3d(-p.x(), -p.y(), p.z());
}

}  // namespace planlight
