#include "app/recording/match_fate.h"

#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "app/recording/session_events.h"
#include "planning_io/types/error.h"
#include "projection/light_gate.h"

namespace planlight {
namespace {

using Json = nlohmann::ordered_json;

/// Hours of updates and rulings, as the recorder writes them, say nothing of a match, and are not parsed.
bool may_tell(std::string_view text) {
    const auto begins = [&](std::string_view with) { return text.starts_with(with); };
    if (!begins(R"({"what":")")) return true;
    if (begins(R"({"what":"asked")")) return !begins(R"({"what":"asked","call":"update")");
    if (begins(R"({"what":"gate","call":"step")") || begins(R"({"what":"gate","call":"forbids")"))
        return text.find(R"("stop":true)") != std::string_view::npos;
    return begins(R"({"what":"matched")") || begins(R"({"what":"resumed")") || begins(R"({"what":"refused")") ||
           begins(R"({"what":"gate")");
}

bool is_sure(const KeptMatch& match) {
    return match.registration.verdict == Verdict::yes || match.confirmed;
}

}  // namespace

void FateOfMatches::set(MatchFate fate, std::string why) {
    fate_ = fate;
    why_ = std::move(why);
}

void FateOfMatches::take(const RecordingChunk& chunk) {
    if (chunk.type == chunk_types::kMatch) return take_match(chunk.payload);
    if (chunk.type != chunk_types::kEvent || !may_tell(chunk.payload)) return;
    try {
        take_event(chunk.payload);
    } catch (const Json::exception&) {
        throw DamagedFileError(recording_, "holds an event that cannot be understood", "Copy the file again.");
    }
}

/// One that was found stands behind its event; any other is of an earlier session, and offered.
void FateOfMatches::take_match(const std::string& text) {
    untouched_ = false;
    if (std::exchange(awaits_match_, false)) {
        last_ = text;
        if (fate_ == MatchFate::stands) stood_ = text;
        return;
    }
    offered_ = last_ = text;
    confirmed_ = false;
    if (is_sure(kept_match_of(text, recording_)))
        set(MatchFate::offered, "the match of an earlier session was offered, and nobody took it up");
    else
        set(MatchFate::unconfirmed,
            "the match of an earlier session was offered, but it was doubtful, and nobody "
            "confirmed it");
}

void FateOfMatches::take_event(const std::string& text) {
    const Json event = Json::parse(text);
    const std::string what = event.at("what"), call = event.value("call", "");
    if (what == "asked" && call == "scan") {
        untouched_ = stood_of_this_scan_ = false;
        scanned_since_ = true;
        last_.clear();
        set(MatchFate::superseded, "a new scan had begun in that session, and it did not come to a match");
    }
    if (what == "asked" && call == "find_patient") {
        last_.clear();
        set(MatchFate::looked_anew, "the patient was looked for anew in that session, and was not found");
    }
    if (what == "matched") take_verdict(event.value("verdict", ""));
    if (what == "resumed") take_resumption();
    // A doubtful one waits for a person's word all the same.
    if (what == "refused" && call == "resume" && fate_ != MatchFate::unconfirmed)
        set(MatchFate::not_resumed,
            "the match of an earlier session was offered and did not fit: " + event.value("why", ""));
    if (what == "asked" && call == "confirm" && fate_ == MatchFate::unconfirmed) {
        confirmed_ = true;
        stand();
    }
    if (what != "gate") return;
    if (call == "new_match") light_stopped_ = false, skin_off_mm_ = 0;
    if (call == "restart") light_stopped_ = false;
    if (call == "skin_checked") {
        skin_off_mm_ = session_events::skin_off_mm(event);
        light_stopped_ |= skin_off_mm_ > LightGateSettings{}.stop_mm;
    }
    if (event.value("stop", false)) light_stopped_ = true;
}

void FateOfMatches::take_verdict(const std::string& verdict) {
    awaits_match_ = verdict != "no";
    confirmed_ = light_stopped_ = false;
    skin_off_mm_ = 0;
    last_.clear();
    if (verdict == "yes") return stand();
    if (verdict == "no") set(MatchFate::refused, "the match was refused");
    if (verdict == "ask") set(MatchFate::unconfirmed, "its match was doubtful, and nobody confirmed it");
    // Another look at the same scan speaks against what was found there before.
    if (std::exchange(stood_of_this_scan_, false)) stood_.clear();
}

/// It agrees with markers and skin; that a doubtful one is right is said by a person alone. Of an anonymous recording
/// it was not kept: then it was one that may be gone on with.
void FateOfMatches::take_resumption() {
    if (offered_.empty() || is_sure(kept_match_of(offered_, recording_))) return stand();
    set(MatchFate::unconfirmed,
        "the match of an earlier session was gone on with, but it was doubtful, and nobody confirmed it");
}

void FateOfMatches::stand() {
    set(MatchFate::stands, kNobody);
    stood_ = last_;  // empty until its MTCH comes, or for good: an earlier one is not the one that stands
    stood_confirmed_ = confirmed_;
    stood_of_this_scan_ = true;
    scanned_since_ = false;
    ++times_stood_;
}

std::string FateOfMatches::stopped() const {
    if (!light_stopped_ && skin_off_mm_ <= LightGateSettings{}.stop_mm) return {};
    return "its light was stopped in that session, because it lay beside the plan or the skin beside it";
}

std::optional<KeptMatch> FateOfMatches::last() const {
    if (last_.empty()) return std::nullopt;
    KeptMatch match = kept_match_of(last_, recording_);
    match.confirmed |= confirmed_;
    return match;
}

std::optional<KeptMatch> FateOfMatches::stood() const {
    if (stood_.empty()) return std::nullopt;
    KeptMatch match = kept_match_of(stood_, recording_);
    match.confirmed |= stood_confirmed_;
    return match;
}

}  // namespace planlight
