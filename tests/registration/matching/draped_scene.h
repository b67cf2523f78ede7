#pragma once

#include <string>
#include <vector>

#include "tests/registration/matching/trial_scan.h"

namespace planlight::test {

/// A kind of covering. Half of them were looked at while the match was made, the others were kept aside.
struct Draping {
    std::string name;
    bool looked_at;
};
const std::vector<Draping>& drapings();

/// A face among what is laid round it, over it and held before it.
struct DrapedSceneSettings {
    std::string draping;                                     ///< of drapings()
    Eigen::Vector3d from_in_ct = -Eigen::Vector3d::UnitY();  ///< from the face to the devices
    Eigen::Vector3d face_in_ct = Eigen::Vector3d::Zero();    ///< about the middle of what is left free, in the head
    double roll = 0;                                         ///< of the picture about the view, radians
    double window_mm = 320;                                  ///< the picture's width; 4:3
    double opening_mm = 120;                                 ///< about how wide the skin left free is
    int points = 30000;
    double noise_mm = 0.3, stray_share = 0.02;
    bool without_head = false;  ///< everything as it would lie on the head, and no head
    unsigned seed = 1;          ///< of everything that is drawn, the pose included
};

struct DrapedScene {
    TrialScan scan;  ///< `bare_points` on skin, `drape_points` on anything else; of the head: targets and middle
    double skin_width_mm = 0;   ///< second largest extent of the skin that is seen
    std::vector<char> is_skin;  ///< per point of the cloud
};

/// What a projector 0.9 m away lights and at least one of two cameras, 220 mm to both sides, sees. Steeper than 75
/// degrees and beyond the CT's ends nothing is seen of the head. Empty when less than 400 rays meet skin, or cloth
/// where there is no head.
DrapedScene draped_scene(const TrialSurface& head, const DrapedSceneSettings& settings);

}  // namespace planlight::test
