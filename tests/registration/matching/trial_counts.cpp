#include "tests/registration/matching/trial_counts.h"

#include <fmt/format.h>

namespace planlight::test {

TrialCounts::TrialCounts(const std::vector<TrialRecord>& all, const TrialsThat& in) {
    for (const TrialRecord& r : all) {
        if (!in(r)) continue;
        trials.push_back(&r);
        ++verdicts[static_cast<std::size_t>(r.verdict)];
        found += r.found();
        found_finally += r.found_finally();
        if (r.verdict < 2) wrong[static_cast<std::size_t>(r.verdict)] += r.wrong();
    }
}

std::vector<double> TrialCounts::values(double TrialRecord::*field, const TrialsThat& also) const {
    std::vector<double> result;
    for (const TrialRecord* r : trials)
        if (!also || also(*r)) result.push_back(r->*field);
    return result;
}

std::vector<double> TrialCounts::target_mm(PoseError TrialRecord::*pose, const TrialsThat& also) const {
    std::vector<double> result;
    for (const TrialRecord* r : trials)
        if (also(*r)) result.push_back((r->*pose).target_mm);
    return result;
}

std::vector<TrialRecord> run_trials(const TrialOptions& options, const std::function<TrialRecord(unsigned)>& trial) {
    TrialLog log(options.log);
    const double before = processor_seconds();
    for (unsigned i = 0; i < options.trials; ++i) {
        if (log.holds(options.seed + i)) continue;
        log.add(trial(options.seed + i));
        if (i % 20 == 0)
            fmt::print(stderr, "\r{} of {}, {:.0f} processor seconds", i, options.trials, processor_seconds() - before);
    }
    fmt::print(stderr, "\n");
    return log.records();
}

}  // namespace planlight::test
