#include "registration/matching/register_with_landmarks.h"

#include <fmt/format.h>

namespace planlight {
namespace {

/// "the scan alone: ..." so that nobody takes the reason for one against the pose that is shown.
void add_reasons(const std::string& of, const std::vector<std::string>& reasons, RegistrationResult& result) {
    for (const std::string& reason : reasons) result.reasons.push_back(of + ": " + reason);
}

}  // namespace

RegistrationResult register_with_landmarks(const PointCloud& cloud, const SkinLut& lut,
                                           const std::vector<PointPair>& pairs, const RegistrationSettings& settings,
                                           const PointPairSettings& pair_settings) {
    RegistrationResult alone = register_patient(cloud, lut, settings);
    const bool sure = alone.verdict == Verdict::yes;
    check_with_point_pairs(pairs, alone, pair_settings);
    if (alone.verdict != Verdict::no || sure || pairs.empty()) return alone;
    const RegistrationResult by_pairs = register_point_pairs(pairs, pair_settings);
    if (by_pairs.verdict == Verdict::no) {
        add_reasons("the landmarks", by_pairs.reasons, alone);
        return alone;
    }
    RegistrationResult helped = register_patient_near(cloud, lut, by_pairs.patient_from_ct, settings);
    helped.initial_match_s = alone.initial_match_s;
    const bool found = helped.verdict != Verdict::no;
    if (!helped.reasons.empty())
        helped.reasons.front() =
            found ? fmt::format("found with the help of {} landmarks: look at the light on others", pairs.size())
                  : fmt::format("the scan does not fit where {} landmarks put it", pairs.size());
    check_with_point_pairs(pairs, helped, pair_settings);
    add_reasons("the scan alone", alone.reasons, helped);
    return helped;
}

}  // namespace planlight
