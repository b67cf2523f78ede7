#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "app/session.h"
#include "planning_io/types/stereo_frame.h"

namespace planlight {

/// Where the plan lies in both pictures of a frame; empty: nowhere that is known.
struct PlanRegion {
    /// Pixels on the plan's lines, and how far round them the picture is kept; pixels on its labels, and how far round
    /// them it is not: they hold the names of the items.
    struct InPicture {
        std::vector<Eigen::Vector2d> pixels, of_labels;
        double radius_px = 0, label_radius_px = 0;
    };
    InPicture left, right;
};

/// By the session's pose of now.
PlanRegion plan_region(const Session& session, const TrackedPose& pose);

/// The picture as a mosaic of 24 cells from left to right, but for what lies in the region: no face is known again in
/// it, and no sharper picture can be made of it.
GrayImage blurred_outside(const GrayImage& picture, const PlanRegion::InPicture& region);

/// Names that are to stand nowhere, with what stands in their place.
class NamesLeftOut {
public:
    /// Those of the case: titles, patient, plan, series; risk structures are "structure 1", "structure 2".
    explicit NamesLeftOut(const Case& the_case);
    /// Of the plan's items: "item 1", "item 2".
    void add_items(const PlanDrawing& drawing);
    /// An event (JSON) without the names in what it says; empty where it is none.
    std::string out_of(const std::string& json) const;
    /// A sentence without them.
    std::string text_without(std::string text) const;

private:
    void add(const std::string& name, const std::string& instead);
    std::vector<std::pair<std::string, std::string>> names_;
};

}  // namespace planlight
