#include "app/recording/resume_offer.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/recording/match_fate.h"
#include "app/recording/recording_head.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/recording/recording_reader.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScan = "Begin the session without it: scan and register the patient.";

void check_names(const LastMatch& last, const Case& the_case, const fs::path& recording) {
    const RecordingHead& head = last.head;
    const CaseName name = name_of(the_case);
    if (head.volume_hash != name.volume_hash || head.mesh_hash != name.mesh_hash)
        throw InputError(recording,
                         fmt::format("is of the case {}, and this is the case {}", head.case_code, name.code),
                         "Open the case of that session, or begin without it.");
    if (head.plan_hash != the_case.plan_hash)
        throw InputError(recording, "was recorded with another plan than this case has now", kScan);
    const std::string program = recording_head(the_case, {}, RecordMode::events, {}).program_hash;
    if (head.program_hash != program)
        throw InputError(recording,
                         fmt::format("was recorded by another program (planlight {}, {}; this one {})", head.program,
                                     head.program_hash.substr(0, 8), program.substr(0, 8)),
                         kScan);
}

}  // namespace

LastMatch last_match_of(const fs::path& recording) {
    RecordingReader reader(recording);
    reader.want_only([](const ChunkType& type, Instant) {
        return type == chunk_types::kHead || type == chunk_types::kEvent || type == chunk_types::kMatch;
    });
    LastMatch last;
    FateOfMatches matches(recording);
    bool headed = false;
    while (const auto chunk = reader.next()) {
        if (chunk->type == chunk_types::kHead) {
            last.head = head_of(chunk->payload, recording);
            headed = true;
        } else {
            matches.take(*chunk);
        }
    }
    if (!headed)
        throw DamagedFileError(recording, "does not say whose it is",
                               "It ends before its first chunk: there is nothing in it.");
    last.untouched = matches.untouched();
    if (may_be_damaged(reader.end())) {
        last.why_none = "it is damaged, and what became of its match cannot be told";
        return last;
    }
    // What did not agree with markers or skin may agree when they are looked at again, before anything is lit.
    const bool to_be_tried = matches.fate() == MatchFate::stands || matches.fate() == MatchFate::offered ||
                             matches.fate() == MatchFate::not_resumed;
    last.why_none = to_be_tried ? matches.stopped() : matches.why();
    if (last.why_none.empty()) last.match = matches.last();
    if (last.why_none.empty() && !last.match) last.why_none = matches.why();
    if (last.match && last.match->registration.verdict != Verdict::yes && !last.match->confirmed) {
        last.match.reset();
        last.why_none = "its match was doubtful, and nobody confirmed it";
    }
    return last;
}

ResumeOffer resume_offer(const fs::path& recording, const Case& the_case, const RigCalibration* rig) {
    return resume_offer(last_match_of(recording), recording, the_case, rig);
}

ResumeOffer resume_offer(LastMatch last, const fs::path& recording, const Case& the_case, const RigCalibration* rig) {
    check_names(last, the_case, recording);
    if (!last.match) throw InputError(recording, "has no match to go on with: " + last.why_none, kScan);
    const auto& state = last.match->registration.rig;
    if (rig != nullptr && (!state || state->calibrated.hash != hash_of(*rig)))
        throw InputError(recording,
                         fmt::format("was recorded with another rig (calibrated {}, this one {})",
                                     state ? state->calibrated.made_on : "on a day not said", rig->made_on),
                         kScan);
    return {std::move(*last.match), recording, false};
}

std::optional<LastSession> last_session(const fs::path& folder) {
    constexpr auto kOldest = std::chrono::hours(12);
    constexpr auto kAhead = std::chrono::minutes(1);  // the clock may be set back
    const auto now = fs::file_time_type::clock::now();
    std::vector<std::pair<fs::file_time_type, fs::path>> recordings;
    std::error_code fault;
    for (fs::directory_iterator entry(folder, fault), end; !fault && entry != end; entry.increment(fault)) {
        if (entry->path().extension() != ".plrec") continue;
        const auto at = fs::last_write_time(entry->path(), fault);
        if (!fault && now - at <= kOldest && at - now <= kAhead) recordings.emplace_back(at, entry->path());
    }
    std::sort(recordings.rbegin(), recordings.rend());
    for (const auto& [at, recording] : recordings) {
        try {
            LastMatch last = last_match_of(recording);
            if (!last.untouched) return LastSession{recording, std::move(last)};
        } catch (const Error&) {  // no recording, or none that says whose it is
        }
    }
    return std::nullopt;
}

}  // namespace planlight
