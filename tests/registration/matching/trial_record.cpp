#include "tests/registration/matching/trial_record.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "registration/matching/match_evidence.h"
#include "registration/matching/register_patient.h"

namespace planlight::test {
namespace {

constexpr char kSeparator = ';';

std::string line_of(const TrialRecord& r) {
    return fmt::format(
        "{};{};{};{:d};{};{};{};{};{};{};{};{};{};{:d};{};{};{};{};{};{};{};{};{};{};{};{};{};{};{};{};{};{};{};{};{}",
        r.seed, r.kind, r.head, r.right_object, r.width_mm, r.noise_mm, r.strays, r.drape, r.movement_mm, r.view,
        r.movement, r.points, r.verdict, r.searched, r.initial.turn_deg, r.initial.middle_mm, r.initial.target_mm,
        r.final.turn_deg, r.final.middle_mm, r.final.target_mm, r.bound_mm, r.runner_up, r.mirror, r.inliers, r.rms_mm,
        r.median_mm, r.scale, r.weakest_mm, r.bases, r.initial_s, r.refine_s, r.processor_s, r.blocked, r.shape_mm,
        r.reasons);
}

void take(const std::string& text, std::string& into) {
    into = text;
}
void take(const std::string& text, bool& into) {
    into = text == "1";
}
void take(const std::string& text, double& into) {
    into = std::stod(text);
}
void take(const std::string& text, int& into) {
    into = std::stoi(text);
}
void take(const std::string& text, unsigned& into) {
    into = static_cast<unsigned>(std::stoul(text));
}
void take(const std::string& text, std::size_t& into) {
    into = std::stoul(text);
}

template <class... Fields>
void take_all(std::istringstream& in, Fields&... fields) {
    const auto next = [&](auto& into) {
        std::string text;
        std::getline(in, text, kSeparator);
        take(text, into);
    };
    (next(fields), ...);
}

TrialRecord record_of(const std::string& line) {
    TrialRecord r;
    std::istringstream in(line);
    take_all(in, r.seed, r.kind, r.head, r.right_object, r.width_mm, r.noise_mm, r.strays, r.drape, r.movement_mm,
             r.view, r.movement, r.points, r.verdict, r.searched, r.initial.turn_deg, r.initial.middle_mm,
             r.initial.target_mm, r.final.turn_deg, r.final.middle_mm, r.final.target_mm, r.bound_mm, r.runner_up,
             r.mirror, r.inliers, r.rms_mm, r.median_mm, r.scale, r.weakest_mm, r.bases, r.initial_s, r.refine_s,
             r.processor_s, r.blocked, r.shape_mm);
    std::getline(in, r.reasons);
    return r;
}

}  // namespace

double processor_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void run_trial(const TrialScan& scan, const SkinLut& lut, TrialRecord& record) {
    RegistrationSettings settings;
    settings.viewpoint_in_rig = scan.viewpoint_in_rig;
    const double before = processor_seconds();
    const RegistrationResult result = register_patient(scan.cloud, lut, settings);
    record.processor_s = processor_seconds() - before;
    record.points = scan.cloud.size();
    record.verdict = static_cast<int>(result.verdict);
    record.searched = result.initial_match_s > 0 && result.refine_s > 0;
    record.initial = pose_error(result.initial_patient_from_ct, scan);
    record.final = pose_error(result.patient_from_ct, scan);
    if (record.searched)
        for (const auto& target : scan.targets_in_ct)
            record.bound_mm = std::max(record.bound_mm, predicted_error(result.covariance, target).bound_95_mm);
    record.runner_up = result.runner_up_ratio;
    record.mirror = result.mirror_ratio;
    record.inliers = result.inlier_fraction;
    record.rms_mm = result.residual_rms_mm;
    record.median_mm = result.residual_median_mm;
    if (record.searched)
        record.shape_mm = lay_on_skin(scan.cloud, lut, result.patient_from_ct.inverse(), settings.inlier_distance_mm,
                                      result.skin_offset_mm.value_or(0))
                              .shape_rms_mm;
    record.scale = result.scale;
    record.weakest_mm = result.weakest_sigma_mm.value_or(std::numeric_limits<double>::infinity());
    record.blocked = result.blocked_fraction.value_or(0);
    record.bases = result.agreeing_bases;
    record.initial_s = result.initial_match_s;
    record.refine_s = result.refine_s;
    record.reasons = fmt::format("{}", fmt::join(result.reasons, " / "));
}

double confidence(const TrialRecord& r) {
    constexpr double kNoise = 0.01, kNoise_mm = 0.05;
    if (!r.searched) return -std::numeric_limits<double>::infinity();
    return std::log(std::min(r.runner_up, r.mirror) + kNoise) - 0.1 * std::log(r.bound_mm + kNoise_mm);
}

double least_margin(const TrialRecord& r) {
    if (!r.searched) return -std::numeric_limits<double>::infinity();
    const auto margin = [](double value, double no, double yes) { return (value - no) / (yes - no); };
    return std::min({margin(r.inliers, 0.5, 0.7), margin(r.rms_mm, 1.0, 0.7), margin(r.runner_up, 1.05, 1.15),
                     margin(r.mirror, 0.87, 1.15), margin(std::abs(r.scale - 1), 0.03, 0.015),
                     margin(r.weakest_mm, 1.5, 0.5), margin(r.bases, 0, 2)});
}

TrialLog::TrialLog(const std::filesystem::path& file) {
    if (file.empty()) return;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        if (std::count(line.begin(), line.end(), kSeparator) < 33) continue;  // cut off while it was written
        records_.push_back(record_of(line));
        seeds_[records_.back().seed] = true;
    }
    out_.open(file, std::ios::app);
    if (!out_) throw std::runtime_error("cannot write " + file.string());
}

void TrialLog::add(const TrialRecord& record) {
    records_.push_back(record);
    seeds_[record.seed] = true;
    if (out_.is_open()) out_ << line_of(record) << std::endl;
}

double quantile(std::vector<double> values, double share) {
    if (values.empty()) return 0;
    const auto at =
        values.begin() + static_cast<std::ptrdiff_t>(std::ceil(share * static_cast<double>(values.size() - 1)));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

}  // namespace planlight::test
