#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "projection/draw_plan.h"
#include "projection/lay_out_label.h"
#include "projection/skin_paths.h"

namespace planlight {

/// The skin that is already drawn on, so that labels keep clear of it.
class OccupiedSkin {
public:
    static constexpr int kPlan = -1;       ///< lines, ticks, markers
    static constexpr int kNobody = -2;     ///< as `but_of`: nothing is overlooked
    static constexpr int kAllLabels = -3;  ///< as `but_of`: only the plan counts
    static constexpr int kCard = -4;       ///< the card with the patient's name

    /// `owner`: `kPlan`, `kCard`, or the item whose label it is.
    void add(const Eigen::Vector3d& p_in_ct, int owner = kPlan);
    void take_away(const Eigen::Vector3d& p_in_ct, int owner);
    /// `distance_mm` up to the cell size. What belongs to `but_of` is overlooked.
    /// Labels are kept off by `labels_mm` where that is more.
    bool within(const Eigen::Vector3d& p_in_ct, double distance_mm, int but_of = kNobody, double labels_mm = 0) const;

    static constexpr double kCell_mm = 5;

private:
    struct Taken {
        Eigen::Vector3d p_in_ct;
        int owner;
    };
    static std::int64_t key(const Eigen::Vector3i& cell);
    std::unordered_map<std::int64_t, std::vector<Taken>> cells_;
};

/// Skin round markers (`keep_clear_in_ct`), which no light may touch.
void occupy_kept_clear(const SkinSurface& skin, const DrawingSettings& settings, OccupiedSkin& occupied);

/// A text to be put beside something.
struct LabelWish {
    int item = -1;
    LabelText text;
    std::string code;                                ///< "#3": where there is no room for the name; may be empty
    std::vector<SkinSurface::Point> anchors;         ///< places it may stand beside, best first
    double keep_off_mm = 1.5;                        ///< half size of what is drawn at the anchor
    std::optional<Eigen::Vector3d> away_from_in_ct;  ///< the side that is left free: the middle of a closed line
    std::optional<Eigen::Vector3d> facing_in_ct;     ///< unit: skin that faces this way is preferred
    /// Holes and ways in of other items: a text close to one would be taken for its name.
    struct Other {
        Eigen::Vector3d p_in_ct;
        double half_size_mm;
    };
    std::vector<Other> others = {};
    int but_of = OccupiedSkin::kNobody;  ///< whose labels may lie there
    std::vector<double> gaps_mm = {0,  3,  7,
                                   12, 18, 26};  ///< beyond what is drawn at the anchor: these are tried in turn
    double text_height_mm = 0;                   ///< of its capitals; 0: the settings'
    bool leader = true;                          ///< from far away a line leads to it
};

/// The label where it overlaps nothing, the skin is flat and, where the light is known, all of it can be lit: the
/// anchor's own surroundings first; from far away a thin line leads to it, which crosses nothing. Empty where there is
/// no such place, and for a text that cannot be laid out. Letters are mapped one by one by straight ways from the
/// middle of the text (exponential map, at most half the text's width), so that they keep their size and shape on the
/// skin.
std::optional<Label> place_label(const LabelWish& wish, const SkinSurface& skin, const DrawingSettings& settings,
                                 const OccupiedSkin& occupied);

/// Takes the skin under the label and its leader, and gives it back.
void occupy(const Label& label, OccupiedSkin& occupied);
void vacate(const Label& label, OccupiedSkin& occupied);

/// A skin point with the directions in which text runs and stands there, read from outside.
struct TextFrame {
    SkinSurface::Point at;
    Eigen::Vector3d right_in_ct, up_in_ct;  ///< unit, tangent; right x up = outward normal
};

/// The plane that touches the skin at `at`, upright along `up_in_ct` as far as the skin lets it.
TextFrame text_frame(const SkinSurface::Point& at, const Eigen::Vector3d& up_in_ct);

/// The block's outlines on the skin, with its middle at the frame's. Empty when the skin ends under it.
std::optional<Label> draw_label(const SkinSurface& skin, const TextFrame& frame, const TextBlock& block, int item,
                                double text_height_mm);

}  // namespace planlight
