#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "app/kept_match.h"
#include "planning_io/recording/recording_chunk.h"

namespace planlight {

/// What became of the last match of a recorded session.
enum class MatchFate {
    none,         ///< nobody was found, and no match of an earlier session was offered
    offered,      ///< one of an earlier session, not looked at yet
    stands,       ///< light may be drawn by it: found for sure, confirmed by a person, or taken up again
    unconfirmed,  ///< it was doubtful, and nobody has said that it is right
    refused,      ///< what was found is not used; nor is what landmarks spoke against afterwards
    looked_anew,  ///< the patient is looked for anew, by landmarks say: until that has an end, nothing is known
    superseded,   ///< a new scan began, and came to no match
    not_resumed,  ///< one of an earlier session did not agree with markers, rig or skin; it may be tried again
};

/// Tells what became of the matches of a recorded session, by its pieces in their order: the one judge of what a
/// session goes on with, what is exported, and whose figures are reported.
class FateOfMatches {
public:
    explicit FateOfMatches(std::filesystem::path recording) : recording_(std::move(recording)) {}

    /// Takes EVNT and MTCH, and leaves the others. Throws DamagedFileError for what cannot be understood.
    void take(const RecordingChunk& chunk);

    MatchFate fate() const { return fate_; }
    /// Why no light may be drawn by the last one, or why it was not kept; no sentence: "nobody confirmed it".
    const std::string& why() const { return why_; }
    /// Why its light must stay out: it was stopped, and neither a new match nor a restart has come since. Empty: it is
    /// not.
    std::string stopped() const;
    /// The last match, whatever became of it; empty: it was not kept (the recording is anonymous), or a new scan ended
    /// it.
    std::optional<KeptMatch> last() const;
    /// The last one that stood, though something may have come after it. Empty: none, or it was not kept.
    std::optional<KeptMatch> stood() const;
    bool scanned_since() const { return scanned_since_; }  ///< a scan began after that one
    int times_stood() const { return times_stood_; }       ///< how often a match came to stand
    bool untouched() const { return untouched_; }          ///< nobody scanned, and nothing was offered

private:
    void take_match(const std::string& text);
    void take_event(const std::string& text);
    void take_verdict(const std::string& verdict);
    void take_resumption();
    void stand();
    void set(MatchFate fate, std::string why);

    std::filesystem::path recording_;
    MatchFate fate_ = MatchFate::none;
    std::string why_ = kNobody;
    std::string last_, offered_, stood_;  ///< as MTCH has them
    bool awaits_match_ = false;           ///< it stands behind its event
    bool confirmed_ = false, stood_confirmed_ = false;
    bool stood_of_this_scan_ = false, scanned_since_ = false, untouched_ = true;
    bool light_stopped_ = false;
    double skin_off_mm_ = 0;
    int times_stood_ = 0;
    static constexpr const char* kNobody =
        "nobody was found in that session, or it was recorded without what that takes (--anonymous)";
};

}  // namespace planlight
