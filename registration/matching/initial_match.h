#pragma once

#include <memory>
#include <vector>

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/rigid_transform.h"
#include "planning_io/types/skin_lut.h"

namespace planlight {

/// Of the three-contact-point search.
struct InitialMatchSettings {
    double model_spacing_mm = 10;  ///< of the skin samples that the contact points are tried on
    int scoring_points = 96;       ///< scan points in the failure function
    double truncation_mm = 10;     ///< a point deeper in the body than this counts as this deep
    double truncation_outside_mm =
        3;                ///< the same, outside: cloth, hands and hair lie over skin, but no light comes from inside it
    int candidates = 40;  ///< distinct poses that are refined
    int min_bases = 4, max_bases = 40;
    unsigned seed = 1;
};

/// One distinct pose and its cost.
struct MatchCandidate {
    RigidTransform ct_from_rig = RigidTransform::Identity();
    double cost_mm = 0;      ///< mean truncated distance of the scan's sites after refinement
    int agreeing_bases = 0;  ///< independent contact triplets that led to it
};

/// The best distinct poses, best first. Empty when the cloud is too small to hold three contact points.
struct InitialMatch {
    std::vector<MatchCandidate> candidates;
    int bases_tried = 0;
    std::size_t poses_scored = 0;
    double runner_up_ratio = 0;  ///< cost of the second / cost of the first distinct pose; 0 when there is no second
};

/// The skin as the search needs it, worked out once for all scans of a patient. Refers to the table, which must outlive
/// it.
class MatchingSkin {
public:
    explicit MatchingSkin(const SkinLut& lut, const InitialMatchSettings& settings = {});
    ~MatchingSkin();
    MatchingSkin(MatchingSkin&&) noexcept;

    struct Parts;
    const Parts& parts() const { return *parts_; }

private:
    std::unique_ptr<const Parts> parts_;
};

/// The paper's search (Hoppe 2001, 2.2): three scan points are kept in contact with the skin; the table sums the
/// distances of the rest; the global minimum over all such poses wins. From any pose, without a start value.
/// The cloud needs normals (towards the devices): a contact must face the same way on both surfaces.
InitialMatch find_initial_match(const PointCloud& cloud, const SkinLut& lut, const InitialMatchSettings& settings = {});
/// The same on a skin that was made ready with the same settings.
InitialMatch find_initial_match(const PointCloud& cloud, const MatchingSkin& skin,
                                const InitialMatchSettings& settings = {});

}  // namespace planlight
