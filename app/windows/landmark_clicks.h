#pragma once

#include <Eigen/Core>
#include <vector>

#include "planning_io/types/point_pair.h"

namespace planlight {

/// Landmarks as they are clicked: on the skin from CT and on the scan, in turn or in any order that keeps one side at
/// most one ahead. What was clicked last on the side that is ahead is moved by another click there.
class LandmarkClicks {
public:
    void click_skin(const Eigen::Vector3d& p_in_ct) { click(in_ct_, in_rig_, p_in_ct, true); }
    void click_scan(const Eigen::Vector3d& p_in_rig) { click(in_rig_, in_ct_, p_in_rig, false); }
    /// Takes back the last click.
    void undo();
    void clear();

    const std::vector<Eigen::Vector3d>& on_skin() const { return in_ct_; }
    const std::vector<Eigen::Vector3d>& on_scan() const { return in_rig_; }

    /// Those with both places, named by the numbers they are shown with; pairs that were set keep their names.
    std::vector<PointPair> pairs() const;
    void set_pairs(const std::vector<PointPair>& pairs);

    /// How far the pairs lie from each other under the rigid transform that fits them best, rms, mm; 0 for fewer than
    /// three.
    double misfit_mm() const;

private:
    void click(std::vector<Eigen::Vector3d>& here, const std::vector<Eigen::Vector3d>& there, const Eigen::Vector3d& p,
               bool on_skin);

    std::vector<Eigen::Vector3d> in_ct_, in_rig_;
    std::vector<bool> order_;  ///< of the clicks: true on the skin
    std::vector<std::string> names_;
};

}  // namespace planlight
