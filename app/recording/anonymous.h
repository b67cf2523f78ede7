#pragma once

#include <Eigen/Core>
#include <filesystem>
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
    /// Those of the case: titles, patient, plan, series; items and risk structures are "item 1", "structure 1". Of the
    /// patient also each part of the name, in any writing.
    explicit NamesLeftOut(const Case& the_case);
    /// Of somebody else, or of a computer: each part of the name.
    void add_person(const std::string& name);
    /// A folder, as messages name their files.
    void add_place(const std::filesystem::path& folder);
    /// Of the plan's items as they are drawn: "item 1", "item 2".
    void add_items(const PlanDrawing& drawing);
    /// An event (JSON) without the names in what it says; empty where it is none.
    std::string out_of(const std::string& json) const;
    /// The event of a room, which has its name and notes from a person who may have named anybody in them.
    std::string out_of_room(const std::string& json) const;
    /// A sentence without them.
    std::string text_without(std::string text) const;

private:
    struct LeftOut {
        std::string name, instead;
        bool part = false;  ///< of a person's name: any writing, and nothing but a name (`is_meant_part`)
    };
    void add(const std::string& name, const std::string& instead, bool part = false);
    std::vector<LeftOut> names_;
};

}  // namespace planlight
