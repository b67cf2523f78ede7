#pragma once

#include <string>

#include "registration/matching/find_skin.h"
#include "registration/matching/match_evidence.h"
#include "registration/matching/register_patient.h"

namespace planlight {

/// The verdict as it grows worse, with a sentence for each step.
class Judgement {
public:
    explicit Judgement(RegistrationResult& result, Verdict at_best = Verdict::yes) : result_(result) {
        result_.verdict = at_best;
    }
    void ask_if(bool doubtful, const std::string& reason) { lower_if(doubtful, Verdict::ask, reason); }
    void no_if(bool wrong, const std::string& reason) { lower_if(wrong, Verdict::no, reason); }

private:
    void lower_if(bool condition, Verdict verdict, const std::string& reason) {
        if (!condition) return;
        if (result_.verdict != Verdict::no) result_.verdict = verdict;
        result_.reasons.push_back(reason);
    }
    RegistrationResult& result_;
};

/// What the fine match is judged by beside the result's own numbers.
struct FineMatch {
    CloudOnSkin fit;
    double skin_offset_mm = 0;
    WeakestWay weakest;
};

/// How much of the scan lies on the skin, and how closely. `place_known`: no other pose comes near, or a start was
/// given.
void judge_fit(const RegistrationSettings& settings, const CloudOnSkin& fit, bool place_known, Judgement& judgement);
/// Whether another pose, or the mirror image with a poor fit, does as well.
void judge_uniqueness(const RegistrationSettings& settings, const RegistrationResult& result, Judgement& judgement);
/// Free space, mirror image, scale, offset of the skin, weakest way.
void judge_fine_match(const RegistrationSettings& settings, const FineMatch& fine, const RegistrationResult& result,
                      Judgement& judgement);
/// The skin that was found among cloth: enough of it, held tighter than a whole scan is, and the rest of the scan only
/// where cloth can be.
void judge_found_skin(const RegistrationSettings& settings, const FoundSkin& found, const FineMatch& fine,
                      const RegistrationResult& result, Judgement& judgement);

}  // namespace planlight
