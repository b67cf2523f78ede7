#include "app/export/match_that_stood.h"

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "planning_io/recording/recording_reader.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// Goes through matches and what was said of them, in their order.
class Fate {
public:
    explicit Fate(fs::path recording) : recording_(std::move(recording)) {}

    void take_match(std::string text) {
        last_ = std::move(text);
        const std::string verdict = std::exchange(verdict_, {});  // none: one of an earlier session, that is offered
        if (verdict == "yes") stand();
        doubtful_ = verdict == "ask";
        if (doubtful_) why_ = "its match was doubtful, and nobody confirmed it";
    }

    void take_event(const Json& event) {
        const std::string what = event.value("what", ""), call = event.value("call", "");
        if (what == "asked" && call == "scan") {
            verdict_.clear();
            of_this_scan_ = doubtful_ = false;
            scanned_later_ = true;
            why_ = "its scan came to no match";
        }
        if (what == "matched") take_verdict(event.value("verdict", ""));
        if (what == "resumed") take_resumption();
        if (what == "asked" && call == "confirm" && std::exchange(doubtful_, false)) {
            stand();
            confirmed_ = true;
        }
        if (what == "refused" && call == "resume")
            why_ = "the match of an earlier session was offered and did not fit: " + event.value("why", "");
    }

    MatchThatStood found() const {
        if (standing_.empty())
            throw InputError(recording_, "holds no match that stood: " + why_,
                             "Name the recording of a session in which the patient was found.");
        MatchThatStood found{kept_match_of(standing_, recording_), scanned_later_};
        found.match.confirmed |= confirmed_;
        return found;
    }

private:
    /// It agrees with markers and skin; that a doubtful one is right is said by a person alone.
    void take_resumption() {
        const KeptMatch match = kept_match_of(last_, recording_);
        if (match.registration.verdict == Verdict::yes || match.confirmed) return stand();
        doubtful_ = true;
        why_ = "the match of an earlier session was gone on with, but it was doubtful, and nobody confirmed it";
    }

    /// Told before the match itself.
    void take_verdict(const std::string& verdict) {
        verdict_ = verdict;
        doubtful_ = false;
        if (verdict == "yes") return;
        if (verdict == "no") why_ = "the match was refused";
        if (std::exchange(of_this_scan_, false)) standing_.clear();  // another look at the same scan
    }

    void stand() {
        standing_ = last_;
        of_this_scan_ = true;
        scanned_later_ = confirmed_ = doubtful_ = false;
    }

    fs::path recording_;
    std::string last_, standing_, verdict_;
    std::string why_ = "nobody was found in it, or it was recorded without what that takes (--anonymous)";
    bool of_this_scan_ = false, doubtful_ = false, scanned_later_ = false, confirmed_ = false;
};

}  // namespace

MatchThatStood match_that_stood(const fs::path& recording) {
    RecordingReader reader(recording);
    reader.want_only(
        [](const ChunkType& type, Instant) { return type == chunk_types::kEvent || type == chunk_types::kMatch; });
    Fate fate(recording);
    try {
        while (const auto chunk = reader.next())
            if (chunk->type == chunk_types::kMatch)
                fate.take_match(chunk->payload);
            else
                fate.take_event(Json::parse(chunk->payload));
    } catch (const Json::exception&) {
        throw DamagedFileError(recording, "holds an event that cannot be understood", "Copy the file again.");
    }
    if (may_be_damaged(reader.end()))  // what came of the match may stand in the part that cannot be read
        throw DamagedFileError(recording, "is damaged: " + reader.sentence(),
                               "Copy the file again from where it was written.");
    return fate.found();
}

}  // namespace planlight
