#pragma once

#include <Eigen/Core>
#include <string>
#include <unordered_map>
#include <vector>

#include "projection/draw_plan.h"
#include "projection/skin_paths.h"

namespace planlight {

/// The skin that is already drawn on, so that labels keep clear of it.
class OccupiedSkin {
public:
    void add(const Eigen::Vector3d& p_in_ct);
    bool within(const Eigen::Vector3d& p_in_ct, double distance_mm) const;  ///< `distance_mm` up to the cell size

    static constexpr double kCell_mm = 3;

private:
    static std::int64_t key(const Eigen::Vector3i& cell);
    std::unordered_map<std::int64_t, std::vector<Eigen::Vector3d>> cells_;
};

/// A text to be put beside something.
struct LabelWish {
    int item = -1;
    std::string text;                         ///< parts that may stand on lines of their own are parted by two blanks
    std::vector<SkinSurface::Point> anchors;  ///< places it may stand beside, best first
    double keep_off_mm = 1.5;                 ///< half size of what is drawn at the anchor
    std::optional<Eigen::Vector3d> away_from_in_ct;  ///< the side that is left free: the middle of a closed line
    std::optional<Eigen::Vector3d> facing_in_ct;     ///< unit: skin that faces this way is preferred
    bool may_overlap = true;  ///< where nothing is free the least taken place will do; else there is no text then
};

/// The text's strokes where they overlap nothing and the skin is flat, the anchor's own surroundings first; a thin line
/// leads to it when it had to go far. Adds them to `occupied`. Letters are mapped one by one by straight ways from the
/// middle of the text (exponential map, at most half the text's width), so that they keep their size and shape on the
/// skin.
std::vector<Stroke> place_label(const LabelWish& wish, const SkinSurface& skin, const DrawingSettings& settings,
                                OccupiedSkin& occupied);

/// The text's lines, and their outline on the skin.
struct TextBlock {
    std::vector<std::u32string> lines;
    double width_mm = 0, height_mm = 0;
};

/// Lines of the text, and the size of their block with letters of this height.
TextBlock lay_out(const std::string& text, double text_height_mm);

/// A skin point with the directions in which text runs and stands there, read from outside.
struct TextFrame {
    SkinSurface::Point at;
    Eigen::Vector3d right_in_ct, up_in_ct;  ///< unit, tangent; right x up = outward normal
};

/// The plane that touches the skin at `at`, upright along `up_in_ct` as far as the skin lets it.
TextFrame text_frame(const SkinSurface::Point& at, const Eigen::Vector3d& up_in_ct);

}  // namespace planlight
