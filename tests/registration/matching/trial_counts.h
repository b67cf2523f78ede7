#pragma once

#include <array>
#include <functional>
#include <vector>

#include "tests/registration/matching/trial_options.h"
#include "tests/registration/matching/trial_record.h"

namespace planlight::test {

using TrialsThat = std::function<bool(const TrialRecord&)>;

/// The trials of one row of a table, counted.
struct TrialCounts {
    std::vector<const TrialRecord*> trials;
    std::size_t found = 0, found_finally = 0;
    std::array<std::size_t, 3> verdicts{};  ///< yes, ask, no
    std::array<std::size_t, 2> wrong{};     ///< with a yes, with an ask

    TrialCounts(const std::vector<TrialRecord>& all, const TrialsThat& in);
    bool empty() const { return trials.empty(); }
    double percent(std::size_t of) const { return 100. * static_cast<double>(of) / static_cast<double>(trials.size()); }
    /// A field of all of them, or of those that also hold.
    std::vector<double> values(double TrialRecord::*field, const TrialsThat& also = {}) const;
    /// How far off the targets are, mm, before or after the fine match.
    std::vector<double> target_mm(PoseError TrialRecord::*pose, const TrialsThat& also) const;
};

/// Runs `trial` for every seed that the log does not hold yet, says how far it is, and returns all of the log.
std::vector<TrialRecord> run_trials(const TrialOptions& options, const std::function<TrialRecord(unsigned)>& trial);

}  // namespace planlight::test
