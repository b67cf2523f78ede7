#include "planning_io/plan/coordinate_space.h"

#include <string>

#include "planning_io/types/error.h"

namespace planlight {

namespace fs = std::filesystem;

std::optional<Space> space_named(std::string_view word) {
    if (word == "LPS") return Space::lps;
    if (word == "RAS") return Space::ras;
    return std::nullopt;
}

std::optional<Space> space_marked(std::string_view header, const fs::path& file) {
    constexpr std::string_view kMark = "SPACE=";
    std::optional<Space> said;
    for (auto at = header.find(kMark); at != std::string_view::npos; at = header.find(kMark, at + 1)) {
        const auto begin = at + kMark.size();
        const auto end = header.find_first_of(" \t\r\n\0", begin, 5);
        const std::string word(header.substr(begin, (end == std::string_view::npos ? header.size() : end) - begin));
        const auto space = space_named(word);
        if (!space)
            throw InputError(file, "says SPACE=" + word.substr(0, 20) + ", neither LPS nor RAS",
                             "Export it again in LPS or RAS.");
        if (said && *said != *space)
            throw InputError(file, "says both SPACE=LPS and SPACE=RAS", "Export it again in one coordinate system.");
        said = space;
    }
    return said;
}

Space settled_space(std::optional<Space> file_says, std::optional<Space> person_says, const fs::path& file,
                    std::string_view how_to_say, std::string_view option) {
    const std::string by(option);
    if (!file_says && !person_says)
        throw InputError(
            file, "does not say its coordinate system",
            std::string(how_to_say) + (by.empty() ? "." : ", or say it with " + by + " LPS or " + by + " RAS."));
    if (file_says && person_says && *file_says != *person_says)
        throw InputError(file,
                         std::string("says that it is in ") + (*file_says == Space::lps ? "LPS" : "RAS") + ", " + by +
                             " says otherwise",
                         "Leave " + by + " out, or export the file again.");
    return file_says ? *file_says : *person_says;
}

}  // namespace planlight
