#pragma once

#include <Eigen/Core>
#include <vector>

#include "registration/matching/coarse_distance.h"
#include "registration/matching/contact_triplets.h"
#include "registration/matching/distance_field.h"
#include "registration/matching/initial_match.h"
#include "registration/matching/point_arrays.h"
#include "registration/matching/surface_sites.h"

namespace planlight {

/// What the search needs of the skin.
struct MatchingSkin::Parts {
    DistanceField field;
    CoarseDistance coarse;
    SkinPairs pairs;
    Parts(const SkinLut& lut, const InitialMatchSettings& settings);
};

/// What all bases of a scan, or of a part of it, share: its sites in a random but fixed order, and the skin they are
/// tried on.
struct PoseSearch {
    const MatchingSkin::Parts& skin;
    std::vector<SurfaceSite> scan;
    std::vector<Eigen::Vector3f> scoring;
    PointArrays refining, ranking;  ///< about the scan's centre
    PointArrays ranking_normals;
    Eigen::Vector3d centre_in_rig = Eigen::Vector3d::Zero();
    InitialMatchSettings settings;
};

/// `sites` in rig.
PoseSearch prepare_search(std::vector<SurfaceSite> sites, const MatchingSkin& skin,
                          const InitialMatchSettings& settings);

/// Nearer than 8 mm at the scan's centre and 8 degrees: the same minimum.
bool same_pose(const PoseSearch& search, const RigidTransform& a, const RigidTransform& b);

/// Mean truncated distance of up to 500 sites, trilinear; a site that faces the wrong way counts in full, one that lies
/// outside of the body little, one beyond the table half: a stray, or the patient beyond the CT's end.
double mean_failure(const PoseSearch& search, const RigidTransform& ct_from_rig);

/// The distinct minima that one base leads to; adds to `scored` how many poses were looked at.
std::vector<MatchCandidate> candidates_of_base(const PoseSearch& search, const Base& base, std::size_t& scored);

}  // namespace planlight
