#pragma once

#include <string>

#include "segmentation/ct_greys.h"
#include "segmentation/skin_judgement.h"
#include "segmentation/skin_shape.h"

namespace planlight {

/// Which way of the patient a line runs, nearest: "left and right", "front and back", "head and feet".
std::string way_in_words(const Eigen::Vector3d& along_in_ct);

/// Adds to `judgement` what the series betrays, whatever skin was found: greys that are no HU or were cut off at their
/// dark end, noise, fat that was drawn aside, thick slices, a patient who moved between slices or (of an MR) within the
/// series. What of it moves the skin goes into `sigma_mm`.
void doubt_series(const Volume& volume, const SkinMask& mask, const HeadBall& ball, const CtGreys& greys,
                  SkinJudgement& judgement);

}  // namespace planlight
