#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "projection/check_marks.h"
#include "projection/draw_plan.h"
#include "projection/label_names.h"
#include "projection/place_all_labels.h"
#include "projection/skin_paths.h"
#include "projection/skin_place.h"

namespace planlight {

/// Draws the items of a plan one after the other, first all osteotomy lines, then boreholes, trajectories and cut
/// planes; last what shares the room between them: labels and check marks. `draw_plan` does so.
class PlanDrawer {
public:
    PlanDrawer(const SkinSurface& ct_skin, const SkinSurface& skin_now, const DrawingSettings& settings,
               std::vector<Clearances> clearances)
        : ct_skin_(ct_skin), skin_(skin_now), settings_(settings), clearances_(std::move(clearances)) {}

    /// First: what the light calls each item; warned of where it is not the plan's name.
    void name_items(const Plan& plan);
    void draw(const OsteotomyLine& line);
    void draw(const Borehole& hole);
    void draw(const Trajectory& trajectory);
    void draw(const CutPlane& plane);
    /// Last. Labels have the choice of places, and marks what is left; where that leaves an item untold its marks
    /// choose first, unless that costs a label.
    void draw_labels_and_marks();
    PlanDrawing drawing;

private:
    int begin(StrokeKind kind, const std::string& name, const Eigen::Vector3d& anchor, double distance_mm,
              std::vector<std::string> warnings);
    bool too_far(const DrawnItem& item) const;
    bool has_place(DrawnItem& item, const PlaceOnSkin& now, const char* what, bool axis) const;
    DrawnItem& item(int i) { return drawing.items[static_cast<std::size_t>(i)]; }
    void add(StrokeKind kind, int item_index, Rgb colour, double width_mm, const SkinLine& line);
    void add_bar(StrokeKind kind, int item_index, Rgb colour, const SkinSurface::Point& at,
                 const Eigen::Vector3d& direction, double back_mm, double ahead_mm);
    void add_ticks(int item_index, Rgb colour, const SkinLine& line);
    void allow_marks(int item_index, Rgb colour, const SkinSurface::Point& at, double crossed_from_mm,
                     double between_from_mm);
    void allow_marks_at_ends(int item_index, Rgb colour, const SkinLine& line);
    void wish(int item_index, std::vector<std::string> figures, std::vector<SkinSurface::Point> anchors,
              double keep_off_mm, std::optional<Eigen::Vector3d> away_from = {});
    std::optional<RiskText> risk_of(const DrawnItem& named) const;
    void wish_along(int item_index, const std::string& figure, const SkinLine& line);
    double planned_length_mm(const CutPlane& plane, const SkinLine& drawn) const;

    const SkinSurface& ct_skin_;  ///< on which was planned
    const SkinSurface& skin_;     ///< as it is now: what is drawn on
    const DrawingSettings& settings_;
    std::vector<Clearances> clearances_;  ///< in the order of the items, as all of these
    std::vector<LitName> names_;
    std::map<std::string, std::string> structures_;  ///< the plan's name of a risk structure, and the light's
    std::vector<LabelWish> wishes_;
    std::vector<MarkPlace> marks_;
};

}  // namespace planlight
