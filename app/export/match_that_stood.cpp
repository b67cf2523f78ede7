#include "app/export/match_that_stood.h"

#include "app/recording/match_fate.h"
#include "planning_io/recording/recording_reader.h"
#include "planning_io/types/error.h"

namespace planlight {

namespace fs = std::filesystem;

MatchThatStood match_that_stood(const fs::path& recording) {
    RecordingReader reader(recording);
    reader.want_only(
        [](const ChunkType& type, Instant) { return type == chunk_types::kEvent || type == chunk_types::kMatch; });
    FateOfMatches matches(recording);
    while (const auto chunk = reader.next()) matches.take(*chunk);
    if (may_be_damaged(reader.end()))  // what came of the match may stand in the part that cannot be read
        throw DamagedFileError(recording, "is damaged: " + reader.sentence(),
                               "Copy the file again from where it was written.");
    auto match = matches.stood();
    if (!match)
        throw InputError(recording, "holds no match that stood: " + matches.why(),
                         "Name the recording of a session in which the patient was found.");
    return {std::move(*match), matches.scanned_since()};
}

}  // namespace planlight
