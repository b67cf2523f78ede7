#pragma once

#include "segmentation/head_survey.h"
#include "segmentation/level_map.h"

namespace planlight {

/// How air and tissue are told apart; values are above the air.
struct OutlineSettings {
    double threshold = 0;          ///< of the skin, everywhere, in the volume's unit; 0 = found from air and tissue
    double seal_radius_mm = 5;     ///< air does not enter through openings narrower than twice this
    double share_of_tissue = 0.2;  ///< from which on a value is skin: between air and the tissue under the skin nearby
    double least_noises = 6;       ///< and at least so many deviations of the air above the air
    double detach_radius_mm = 2.5;
};

/// The head of an MR as a whole: all that air does not reach from the ends of the volume, dark bone and all.
struct HeadOutline {
    Mask head;  ///< on the survey's grid; empty of ones when there is no head
    LevelMap levels;
    double air = 0, air_sigma = 0, tissue = 0;  ///< round the head and in it, medians; sigma of the smoothed survey
    Mask gone;                                  ///< what shows signal outside the head: rods, wires, cushions, ghosts
    double lower_ml = 0, higher_ml = 0, volume_ml = 0;  ///< at 0.7 and 1.5 times the threshold (above air), and at it
    double unsure_share = 0;  ///< of the outline that lies further than 3 mm apart between those two
};

/// Air is learnt where it is sure (between 6 and 24 mm off the head found so far), block by block; thresholds follow
/// the air's own noise there and the tissue near by. The outside is flooded from the edges of the volume's box.
HeadOutline outline_of(const HeadSurvey& survey, const OutlineSettings& settings = {});

}  // namespace planlight
