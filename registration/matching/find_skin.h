#pragma once

#include <optional>
#include <vector>

#include "planning_io/types/point_cloud.h"
#include "planning_io/types/skin_lut.h"
#include "registration/matching/initial_match.h"

namespace planlight {

struct CloudPieces;

/// Which pieces of a cloud are tried as skin.
struct FindSkinSettings {
    double reach_mm = 60;  ///< of the part of the scan round a place that is tried alone
    int max_places = 140;  ///< that are tried, those whose shape holds a pose best first
    int bases_per_place = 2;
    double near_mm = 2;           ///< of the skin: a cell that far from it, facing as it does, may be skin
    double inside_mm = 3;         ///< deeper in the body than this no light comes from
    double inside_penalty = 1.5;  ///< what a cell that lies inside counts against one that lies on the skin
    double clear_ratio = 1.5;     ///< of what the best pose explains to what the next one does: looked for no longer
};

/// What of a scan is skin, by the pose that explains most of it.
struct FoundSkin {
    RigidTransform ct_from_rig = RigidTransform::Identity();
    std::vector<char> is_skin;  ///< per point of the cloud
    double explained = 0;       ///< cells (25 mm^2 each) on the skin, the nearer the more, less those inside
    double rival_ratio = 0;  ///< of the best pose to the next distinct one, both as `explained`; 0: there is no other
    double inside_fraction = 0;  ///< of all cells that are no strays
    double skin_fraction = 0;    ///< of all cells that are no strays
    /// Of the skin found: how much goes on smoothly beyond it, beside the skin of the CT and as it faces, but off it.
    /// Cloth begins with a step or a crease; where it is much, the skin is another patient's, or cloth lies close on
    /// it.
    double goes_on_fraction = 0;
    int places_agreeing = 0, places_tried = 0;
};

/// The skin in a scan that is mostly not skin: cloth, hands, instruments lie outside of the body, and no light comes
/// from inside it.
///
/// Parts of the scan round places whose shape holds a pose well are matched alone, within a smooth piece and across
/// creases, with what the search of the whole scan led to (`of_whole`); every pose is then judged on the whole scan,
/// one-sided: what lies on the skin and faces as it does speaks for the pose, what lies inside against it, what lies
/// outside for nothing. Empty when no part fits anywhere.
std::optional<FoundSkin> find_skin(const PointCloud& cloud, const CloudPieces& pieces, const SkinLut& lut,
                                   const MatchingSkin& skin, const InitialMatch& of_whole,
                                   const InitialMatchSettings& search = {}, const FindSkinSettings& settings = {});

}  // namespace planlight
