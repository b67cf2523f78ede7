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

const char* name_of(Space space) {
    return space == Space::lps ? "LPS" : "RAS";
}

Space settled_space(const SpaceSaid& file_says, std::optional<Space> person_says, const fs::path& file,
                    std::string_view how_to_say, std::string_view option) {
    const std::string by(option);
    if (!file_says.space && !person_says)
        throw InputError(
            file, "does not say its coordinate system",
            std::string(how_to_say) + (by.empty() ? "." : ", or say it with " + by + " LPS or " + by + " RAS."));
    if (file_says.space && person_says && *file_says.space != *person_says)
        throw InputError(file,
                         std::string("says that it is in ") + name_of(*file_says.space) + ", " + by + " says otherwise",
                         "Leave " + by + " out, or export the file again.");
    if (!file_says.space)
        for (const SpaceMention& mention : file_says.mentions)
            if (mention.word != name_of(*person_says))
                throw InputError(
                    file,
                    "names " + mention.word + " (\"" + mention.line + "\"), " + by + " says " + name_of(*person_says),
                    "Find out which it is. " + std::string(how_to_say) + "; that is believed.");
    return file_says.space ? *file_says.space : *person_says;
}

}  // namespace planlight
