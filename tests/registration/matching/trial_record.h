#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "planning_io/types/registration_result.h"
#include "planning_io/types/skin_lut.h"
#include "tests/registration/matching/trial_scan.h"

namespace planlight::test {

/// What one trial was and what came of it.
struct TrialRecord {
    unsigned seed = 0;
    std::string kind, head;    ///< kind: the class of the trial; head: whose table
    bool right_object = true;  ///< the scan is of the table's patient, as he is
    double width_mm = 0, noise_mm = 0, strays = 0, drape = 0, movement_mm = 0;
    std::string view, movement;
    std::size_t points = 0;

    int verdict = 2;        ///< 0 yes, 1 ask, 2 no
    bool searched = false;  ///< there was an initial match at all
    PoseError initial{}, final{};
    double bound_mm = 0;  ///< largest 95 % bound that was predicted at a target
    double runner_up = 0, mirror = 0, inliers = 0, rms_mm = 0, median_mm = 0, scale = 1, weakest_mm = 0, blocked = 0;
    double shape_mm = 0;  ///< rms of what lies on the skin, without the scan's own noise
    int bases = 0;
    double initial_s = 0, refine_s = 0,
           processor_s = 0;  ///< the first two by the wall, the last all threads, whole registration
    std::string reasons;

    /// Within 3 degrees and 5 mm before the fine match: the right minimum.
    bool found() const { return searched && right_object && initial.turn_deg < 3 && initial.middle_mm < 5; }
    /// The same of the pose that comes out in the end.
    bool found_finally() const { return searched && right_object && final.turn_deg < 3 && final.middle_mm < 5; }
    /// A pose more than 5 mm off at a target, or any pose at all of a thing that is not there.
    bool wrong() const { return !right_object || final.target_mm > 5; }
};

/// Registers the scan and compares with the truth; fills what the result says.
void run_trial(const TrialScan& scan, const SkinLut& lut, TrialRecord& record);

/// One number for how sure the certificate is: by how much the best rival (another pose, the mirrored scan) costs more,
/// less a little for the predicted error: min(ln runner-up, ln mirror) - 0.1 ln(bound). Chosen on hard trials of the
/// seeds 1 to 1035; others must confirm it. Minus infinity where nothing was found.
double confidence(const TrialRecord& record);

/// As the verdict judges: the least margin of its evidence, each measured from its limit for "no" (0) to that for "yes"
/// (1), or to what good scans reach where there is but one limit.
double least_margin(const TrialRecord& record);

/// A file of trials that were done, so that a run can be cut and go on: one line each.
class TrialLog {
public:
    /// Reads what is there; an empty name keeps nothing.
    explicit TrialLog(const std::filesystem::path& file);
    const std::vector<TrialRecord>& records() const { return records_; }
    bool holds(unsigned seed) const { return seeds_.contains(seed); }
    void add(const TrialRecord& record);

private:
    std::vector<TrialRecord> records_;
    std::map<unsigned, bool> seeds_;
    std::ofstream out_;
};

/// The value below which `share` of them lie; 0 of none.
double quantile(std::vector<double> values, double share);

/// Seconds of all threads of this process.
double processor_seconds();

}  // namespace planlight::test
