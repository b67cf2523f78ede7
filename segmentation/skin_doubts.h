#pragma once

#include <string>
#include <utility>
#include <vector>

#include "segmentation/skin_judgement.h"

// What the parts of `judge_skin` share.
namespace planlight {

inline constexpr const char* kLookAtTheSkin = "Look at the skin in the report before you use it.";
inline constexpr double kBlurred_mm = 4.2;   ///< from 20 to 80 % of the step from air to skin; more is said
inline constexpr double kOneSided_cm2 = 15;  ///< that one side of a head stands out before the other; more is said

inline void add(std::vector<SkinDoubt>& list, std::string finding, std::string remedy) {
    list.push_back({std::move(finding), std::move(remedy)});
}

}  // namespace planlight
