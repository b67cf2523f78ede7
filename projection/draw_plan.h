#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/camera_model.h"
#include "planning_io/types/image.h"
#include "planning_io/types/plan.h"
#include "planning_io/types/rigid_transform.h"
#include "projection/clearance.h"
#include "projection/skin_surface.h"

namespace planlight {

/// What a stroke belongs to.
enum class StrokeKind { osteotomy_line, borehole, trajectory, cut_plane, tick, label, check_mark };

/// A line on the skin of constant width, measured along the skin.
struct Stroke {
    StrokeKind kind = StrokeKind::osteotomy_line;
    int item = -1;  ///< index into PlanDrawing::items
    Rgb colour{255, 255, 255};
    double width_mm = 0.8;
    bool closed = false;
    std::vector<Eigen::Vector3d> points_in_ct;   ///< on the skin, at most `max_segment_mm` apart
    std::vector<Eigen::Vector3d> normals_in_ct;  ///< outward, one per point
    /// Not lit for `gap_mm` about every whole multiple of this way along it from its first point (not about that
    /// point itself); 0: all of it is lit.
    double gap_every_mm = 0, gap_mm = 0;

    bool in_gap(double way_mm, double margin_mm = 0) const {
        if (!(gap_mm > 0) || !(gap_every_mm > gap_mm) || way_mm < gap_every_mm / 2) return false;
        return std::abs(std::remainder(way_mm, gap_every_mm)) < gap_mm / 2 + margin_mm;
    }
};

/// A label on the skin, lit whole or not at all.
struct Label {
    int item = -1;              ///< index into PlanDrawing::items
    std::string words;          ///< as it can be read, lines parted by a line feed
    double text_height_mm = 0;  ///< of its capitals, along the skin
    double gap_mm = 0;          ///< between what is drawn at the item and it
    Rgb colour{235, 235, 235};
    /// Of one sign of the text: closed lines, filled together (a hole runs the other way round); on the skin.
    using Outlines = std::vector<std::vector<Eigen::Vector3d>>;
    std::vector<Outlines> signs_in_ct;
    std::vector<Eigen::Vector3d> field_in_ct;          ///< the skin under it, 3 mm apart: all of it must be lit
    std::vector<Eigen::Vector3d> field_normals_in_ct;  ///< outward
    Stroke leader;                                     ///< from the item to a label far from it; no points where near
    bool by_code = false;                              ///< says the item's code in place of its name
    bool of_moment = false;  ///< drawn while its item is the item of the moment, and then alone
};

/// One plan item as drawn: where it was wanted and what is said about it.
struct DrawnItem {
    StrokeKind kind;
    std::string name;
    std::string label;                  ///< the text beside it but for risk structures, e.g. "B1  ⌀7  6 mm deep"
    Eigen::Vector3d anchor_in_ct;       ///< its place on the skin
    double distance_to_skin_mm = 0;     ///< of the plan's point(s) to the skin, largest
    std::vector<std::string> warnings;  ///< in words, with the item's name
    bool labelled = true;               ///< false where a crowded plan left no free skin for its label
    std::string lit_name;               ///< the name as the light has it: whole, shortened, or the code
    std::string code;                   ///< "#3" or "#C": for where the name cannot be lit or has no room; may be empty
    bool lit_by_code = false;           ///< the light has the code in place of the name
    Clearances clearances = {};         ///< to the plan's risk structures; what is worst first
    std::string unlit_warning = {};     ///< "through Facial nerve", where that has no room in its label
};

/// The plan in the skin's own metric: what is light on the skin, independent of projector and pose.
struct PlanDrawing {
    std::vector<DrawnItem> items;
    std::vector<Stroke> strokes;
    std::vector<Label> labels;
    /// Whose plan it is and on which side: `DrawingSettings::card`, of no item (-1); empty where no skin was free for
    /// it.
    std::optional<Label> card;
};

/// From where the light will come: labels are put where all of them can be lit.
struct LightView {
    CameraModel projector;
    RigidTransform rig_from_ct = RigidTransform::Identity();
    double steepest = 1.05;  ///< radians (60 degrees) between the skin under a label and the light
    double margin_px = 6;    ///< to the edge of the picture
};

/// How a plan becomes lines on the skin; lengths in mm on the skin.
struct DrawingSettings {
    double line_width_mm = 0.8;
    double max_segment_mm = 0.5;
    double text_height_mm = 5;   ///< of capitals and digits, along the skin: at least
    double largest_text_mm = 7;  ///< where there is room; no more than the least: all are of one height
    double tick_every_mm = 10, tick_length_mm = 2;  ///< along osteotomy lines; 0 = none
    Eigen::Vector3d up_in_ct{0, 0, 1};              ///< which way text stands up; zero: +z, as nobody said
    std::optional<LightView> light;                 ///< where it is not known, labels may lie where no light comes
    /// So much of the light's area at most is text: beyond it labels say the name alone, then the code, then nothing.
    double most_text = 0.85;
    double max_distance_to_skin_mm = 10;  ///< a plan point farther from skin is warned of, by name
    bool labels = true;
    bool check_marks = true;  ///< about items too small for the cameras to tell where their light lies
    std::vector<Eigen::Vector3d>
        keep_clear_in_ct;  ///< marker centres: labels are not put within `keep_clear_radius_mm`
    double keep_clear_radius_mm = 11;
    /// A card on the skin near the plan, a line each: the patient's name, then the plan's side; empty: none. It is put
    /// after all labels, apart from everything drawn, and without a leader.
    std::vector<std::string> card;
};

/// Draws every item of the plan on the skin: lengths along geodesics, circles of their diameter, labels upright.
/// A label is put where it overlaps nothing and can be lit whole, or it is left out.
///
/// Items come in the order osteotomy lines, boreholes, trajectories, cut planes. One that is not finite, lies more than
/// three times `max_distance_to_skin_mm` from the skin, or has no place there (`no_place`), has no strokes, but says
/// so.
PlanDrawing draw_plan(const Plan& plan, const SkinSurface& skin, const DrawingSettings& settings = {});

/// The same on the skin as it is now (`skin_as_scanned` of `ct_skin`). What is fixed to the bone stays where it was
/// planned and is drawn where it meets the skin now: holes and trajectories along their axes, cut planes in their
/// planes. What is planned on the skin is carried with it: points of lines, holes without an axis. Distances and
/// warnings are those of the CT. `known`: what `clearances_of` gives for this plan on the CT's skin, in place of
/// measuring it again.
PlanDrawing draw_plan(const Plan& plan, const SkinSurface& ct_skin, const SkinSurface& skin_now,
                      const DrawingSettings& settings = {},
                      std::optional<std::vector<Clearances>> known = std::nullopt);

/// Those of a drawing's items, in their order.
std::vector<Clearances> clearances_in(const PlanDrawing& drawing);

}  // namespace planlight
