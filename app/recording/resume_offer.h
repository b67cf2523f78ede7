#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "app/kept_match.h"
#include "app/recording/session_recorder.h"

namespace planlight {

/// A match that a session may go on with.
struct ResumeOffer {
    KeptMatch match;
    std::filesystem::path recording;  ///< where it is from
    bool at_once = false;             ///< asked for on the command line: no press is waited for
};

/// The match that the session of this recording used last. Its pictures are passed over: an hour's recording
/// takes some seconds (`measure_review`).
struct LastMatch {
    RecordingHead head;
    std::optional<KeptMatch> match;
    std::string why_none;   ///< in words, where there is none
    bool untouched = true;  ///< nobody scanned or went on with anything: a session before it may be gone on with
};
/// Throws DamagedFileError where it does not say whose it is.
LastMatch last_match_of(const std::filesystem::path& recording);

/// What a session of this case can go on with. Throws InputError, with both names, when the recording is of another
/// case, plan, program or (where it is given) rig, or has no match to go on with; DamagedFileError.
ResumeOffer resume_offer(const std::filesystem::path& recording, const Case& the_case,
                         const RigCalibration* rig = nullptr);
/// The same of what `last_match_of` gave.
ResumeOffer resume_offer(LastMatch last, const std::filesystem::path& recording, const Case& the_case,
                         const RigCalibration* rig = nullptr);

/// The last session of that folder, by when its recording was written to, that did anything, if that was in the last
/// twelve hours: what ended before anybody pressed anything, or before it said whose it was, is passed over. Empty:
/// none.
struct LastSession {
    std::filesystem::path recording;
    LastMatch last;
};
std::optional<LastSession> last_session(const std::filesystem::path& folder);

}  // namespace planlight
