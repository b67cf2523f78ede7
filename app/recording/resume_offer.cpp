#include "app/recording/resume_offer.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/recording/recording_head.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/recording/recording_reader.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScan = "Begin the session without it: scan and register the patient.";

/// What the events after a match say of it.
struct Fate {
    std::string match;  ///< its chunk; empty: none
    std::string why_none = "nobody was found in that session, or it was recorded without what that takes (--anonymous)";
    bool confirmed = false;
    bool untouched = true;
    std::string stopped;  ///< why its light was stopped, and not asked for again

    void take(const RecordingChunk& chunk) {
        const std::string& text = chunk.payload;
        if (chunk.type == chunk_types::kMatch) {
            untouched = false;
            match = text;
            confirmed = false;
            stopped.clear();
        } else if (text.starts_with(R"({"what":"asked","call":"scan")")) {
            untouched = false;
            match.clear();
            why_none = "a new scan had begun in that session, and it did not come to a match";
        } else if (text.starts_with(R"({"what":"asked","call":"find_patient")")) {
            match.clear();  // by landmarks, say: a match that they refuse stays refused
            why_none = "the patient was looked for anew in that session, and was not found";
        } else if (text.starts_with(R"({"what":"asked","call":"confirm")")) {
            confirmed = true;
        } else if (text.starts_with(R"({"what":"gate","call":"restart")")) {
            stopped.clear();
        } else if (text.starts_with(R"({"what":"gate")") && text.find(R"("stop":true)") != std::string::npos) {
            stopped = "its light was stopped in that session, because it lay beside the plan or the skin beside it";
        }
    }
};

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
    Fate fate;
    bool headed = false;
    while (const auto chunk = reader.next()) {
        if (chunk->type == chunk_types::kHead) {
            last.head = head_of(chunk->payload, recording);
            headed = true;
        } else {
            fate.take(*chunk);
        }
    }
    if (!headed)
        throw DamagedFileError(recording, "does not say whose it is",
                               "It ends before its first chunk: there is nothing in it.");
    last.untouched = fate.untouched;
    if (may_be_damaged(reader.end())) {
        last.why_none = "it is damaged, and what became of its match cannot be told";
    } else if (fate.match.empty()) {
        last.why_none = fate.why_none;
    } else if (!fate.stopped.empty()) {
        last.why_none = fate.stopped;
    } else {
        last.match = kept_match_of(fate.match, recording);
        last.match->confirmed |= fate.confirmed;
    }
    return last;
}

ResumeOffer resume_offer(const fs::path& recording, const Case& the_case, const RigCalibration* rig) {
    return resume_offer(last_match_of(recording), recording, the_case, rig);
}

ResumeOffer resume_offer(LastMatch last, const fs::path& recording, const Case& the_case, const RigCalibration* rig) {
    check_names(last, the_case, recording);
    if (!last.match) throw InputError(recording, "has no match to go on with: " + last.why_none, kScan);
    if (last.match->registration.verdict != Verdict::yes && !last.match->confirmed)
        throw InputError(recording, "has no match to go on with: its match was doubtful, and nobody confirmed it",
                         kScan);
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
    const auto now = fs::file_time_type::clock::now();
    std::vector<std::pair<fs::file_time_type, fs::path>> recordings;
    std::error_code fault;
    for (fs::directory_iterator entry(folder, fault), end; !fault && entry != end; entry.increment(fault)) {
        if (entry->path().extension() != ".plrec") continue;
        const auto at = fs::last_write_time(entry->path(), fault);
        if (!fault && now - at <= kOldest) recordings.emplace_back(at, entry->path());
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
