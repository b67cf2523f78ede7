#pragma once

#include <string>

#include "segmentation/skin_judgement.h"

namespace planlight {

/// Which way of the patient a line runs, nearest: "left and right", "front and back", "head and feet".
std::string way_in_words(const Eigen::Vector3d& along_in_ct);

/// Adds to `judgement` what the values of the series betray, whatever skin was found: greys that were cut off at their
/// dark end, and (of an MR) a patient who moved within the series.
void doubt_series(const Volume& volume, const SkinMask& mask, SkinJudgement& judgement);

}  // namespace planlight
