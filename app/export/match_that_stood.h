#pragma once

#include <filesystem>

#include "app/kept_match.h"

namespace planlight {

/// The last match of a recording by which light might be drawn: one whose verdict was `yes`, an `ask` that a person
/// confirmed, or one of an earlier session that was taken up again. Not one that landmarks spoke against afterwards.
struct MatchThatStood {
    KeptMatch match;
    bool scanned_later = false;  ///< a later scan began, and came to no match
};

/// Throws InputError with what became of the last match where none stood, or the recording has none (it is anonymous);
/// DamagedFileError.
MatchThatStood match_that_stood(const std::filesystem::path& recording);

}  // namespace planlight
