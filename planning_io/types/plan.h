#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/triangle_mesh.h"

namespace planlight {

using Colour = std::array<float, 3>;  ///< RGB in [0,1]

/// A straight way from an entry on the skin to a target inside.
struct Trajectory {
    std::string name;
    Eigen::Vector3d entry_in_ct, target_in_ct;
    double diameter_mm = 0;  ///< of the instrument; 0 when not given
    std::optional<Colour> colour;
    double length_mm() const { return (target_in_ct - entry_in_ct).norm(); }
};

/// A hole to be drilled, at a point on (or near) the skin, along the inward axis.
struct Borehole {
    std::string name;
    Eigen::Vector3d position_in_ct;
    std::optional<Eigen::Vector3d> axis_in_ct;  ///< unit, inwards; the skin's inward normal when not given
    double diameter_mm = 0;
    double depth_mm = 0;
    std::optional<Colour> colour;
};

/// A line to cut along, given by points on (or near) the skin.
struct OsteotomyLine {
    std::string name;
    std::vector<Eigen::Vector3d> points_in_ct;
    bool closed = false;
    std::optional<Colour> colour;
};

/// A plane to cut along; its trace on the skin is what is drawn.
struct CutPlane {
    std::string name;
    Eigen::Vector3d origin_in_ct;
    Eigen::Vector3d normal_in_ct;        ///< unit
    Eigen::Vector3d first_axis_in_ct;    ///< unit, in the plane
    double width_mm = 0, height_mm = 0;  ///< extent along the first axis and across it, centred on the origin
    std::optional<Colour> colour;
};

/// What an instrument must not hurt: a nerve, a vessel, the dura, the root of a tooth. It is not drawn; the items are
/// measured against it.
struct RiskStructure {
    std::string name;
    TriangleMesh surface;  ///< closed
};

/// All that is to be shown on the patient, in ct (LPS, mm).
struct Plan {
    std::vector<Trajectory> trajectories;
    std::vector<Borehole> boreholes;
    std::vector<OsteotomyLine> osteotomy_lines;
    std::vector<CutPlane> cut_planes;
    std::vector<RiskStructure> risk_structures;  ///< no items: `size` does not count them

    std::size_t size() const {
        return trajectories.size() + boreholes.size() + osteotomy_lines.size() + cut_planes.size();
    }
    bool empty() const { return size() == 0; }
};

}  // namespace planlight
