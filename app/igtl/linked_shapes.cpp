#include "app/igtl/linked_shapes.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

/// Dots stand before lines in the numbers, so they are kept apart until the end.
class PlanShapes {
public:
    void add_line(const std::vector<Vector3d>& points, bool closed) {
        if (points.empty()) return;
        std::vector<std::uint32_t> line;
        for (const Vector3d& p : points) line.push_back(add_point(p));
        if (closed) line.push_back(line.front());
        shapes_.lines.push_back(std::move(line));
        of_lines_.push_back(item_);
    }
    void add_dot(const Vector3d& p) {
        shapes_.dots.push_back(add_point(p));
        of_dots_.push_back(item_);
    }
    void next_item() { item_ += 1; }
    LinkedShapes shapes() {
        shapes_.number_name = "item";
        shapes_.numbers_of_cells = of_dots_;
        shapes_.numbers_of_cells.insert(shapes_.numbers_of_cells.end(), of_lines_.begin(), of_lines_.end());
        return shapes_;
    }

private:
    std::uint32_t add_point(const Vector3d& p) {
        shapes_.points_in_ct.push_back(p);
        return static_cast<std::uint32_t>(shapes_.points_in_ct.size() - 1);
    }
    LinkedShapes shapes_;
    std::vector<float> of_dots_, of_lines_;
    float item_ = 0;
};

std::vector<Vector3d> border_of(const CutPlane& plane) {
    const Vector3d across = plane.normal_in_ct.cross(plane.first_axis_in_ct) * (plane.height_mm / 2),
                   along = plane.first_axis_in_ct * (plane.width_mm / 2);
    const Vector3d& o = plane.origin_in_ct;
    return {o - along - across, o + along - across, o + along + across, o - along + across};
}

}  // namespace

LinkedShapes shapes_of(const TriangleMesh& skin) {
    LinkedShapes shapes;
    shapes.points_in_ct = skin.vertices_in_ct;
    shapes.triangles = skin.triangles;
    return shapes;
}

LinkedShapes shapes_of(const Plan& plan) {
    PlanShapes shapes;
    for (const OsteotomyLine& line : plan.osteotomy_lines) {
        shapes.add_line(line.points_in_ct, line.closed);
        shapes.next_item();
    }
    for (const Trajectory& trajectory : plan.trajectories) {
        shapes.add_line({trajectory.entry_in_ct, trajectory.target_in_ct}, false);
        shapes.next_item();
    }
    for (const Borehole& hole : plan.boreholes) {
        shapes.add_dot(hole.position_in_ct);
        if (hole.axis_in_ct && hole.depth_mm > 0)
            shapes.add_line({hole.position_in_ct, hole.position_in_ct + hole.depth_mm * *hole.axis_in_ct}, false);
        shapes.next_item();
    }
    for (const CutPlane& plane : plan.cut_planes) {
        shapes.add_line(border_of(plane), true);
        shapes.next_item();
    }
    return shapes.shapes();
}

}  // namespace planlight
