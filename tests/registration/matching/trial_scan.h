#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/rigid_transform.h"
#include "tests/registration/matching/trial_surface.h"

namespace planlight::test {

/// One scan: from where, how wide, and what is wrong with it.
struct TrialScanSettings {
    Eigen::Vector3d from_in_ct = -Eigen::Vector3d::UnitY();  ///< from the head's middle to the devices
    double roll = 0;                                         ///< of the window about the view, radians
    Eigen::Vector2d aside_mm{0, 0};                          ///< of the window's middle from the head's middle
    double width_mm = 190;                                   ///< of the window, which is 4:3
    int points = 20000;                                      ///< about
    double noise_mm = 0.3;                                   ///< along the ray, one sigma
    double stray_share = 0.05;    ///< points thrown along their ray, 15 to 100 mm off, either way
    double drape_share = 0;       ///< of the skin in the window, under a cloth
    double drape_height_mm = 15;  ///< of the cloth over the skin
    std::string movement;         ///< of skin_movements(); empty: the skin is as in the CT
    double movement_mm = 0;       ///< rms over the scan
    bool mirrored = false;        ///< the head is the mirror image of the CT's (x -> -x)
    double scale = 1;             ///< of the head against the CT's, about its middle
    unsigned seed = 1;            ///< of everything that is drawn, the pose included
};

struct TrialScan {
    PointCloud cloud;  ///< in rig, with normals from neighbouring points
    RigidTransform rig_from_ct = RigidTransform::Identity();
    Eigen::Vector3d middle_in_ct = Eigen::Vector3d::Zero();  ///< of the bare skin scanned
    std::vector<Eigen::Vector3d> targets_in_ct;              ///< 60 mm deep under the scan: one, and six 40 mm round it
    std::optional<Eigen::Vector3d> viewpoint_in_rig;         ///< the eye of all rays; empty: there is none
    std::size_t bare_points = 0, stray_points = 0, drape_points = 0;
};

/// What a rig 0.9 m away gives of the surface: an even grid of rays through the window, no skin steeper than 75
/// degrees, no lids and cut ends; then the skin's movement, the cloth, noise and strays; normals by planes through 7 x
/// 7 rays as a scan estimates them; moved by a pose even over SO(3) and 150 mm. Empty when less than 200 rays meet
/// skin.
TrialScan trial_scan(const TrialSurface& surface, const TrialScanSettings& settings);

/// How far a pose is from the truth: turn, shift of the scan's middle, and the worst target.
struct PoseError {
    double turn_deg, middle_mm, target_mm;
};
PoseError pose_error(const RigidTransform& patient_from_ct, const TrialScan& scan);

}  // namespace planlight::test
