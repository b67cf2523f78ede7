#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

#include "planning_io/types/volume.h"
#include "segmentation/skin_judgement.h"

// Analytic heads in voxels, and what is said of them.
namespace planlight::test {

/// An MR of 3 mm voxels of what `signal` says at a place (mm, the middle is the origin, the front is at negative y),
/// with Rician noise. The grid may be turned about the body's long axis.
Volume mr_of(const std::function<double(const Eigen::Vector3d&)>& signal,
             const Eigen::Vector3d& half_mm = {105, 125, 115}, double noise = 12, double turn_degrees = 0);

/// Depth under an egg of 75 x 92 x 85 mm, with a nose unless it was taken away; negative outside.
double depth_in_head(const Eigen::Vector3d& p, bool nose = true);
/// The signal of an MR at such a depth: scalp, dark bone, brain.
double layered(double depth);

/// A head with something as bright as scalp where `is_there` says so.
Volume head_with(const std::function<bool(const Eigen::Vector3d& p, double depth)>& is_there, double turn_degrees = 0);

/// A CT in HU of 3 mm voxels of a head with what lies on it (`on_it`: its HU at a place outside the head, -1000 for
/// nothing).
Volume ct_of(const std::function<double(const Eigen::Vector3d& p, double depth)>& on_it,
             const Eigen::Vector3d& half_mm);

struct Judged {
    SkinJudgement skin;
    bool refused = false;
};

Judged judged(const Volume& volume);
/// Whether a doubt has this in it.
bool doubts(const SkinJudgement& skin, const std::string& word);

}  // namespace planlight::test
