#include "planning_io/plan/plan_shapes.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <map>
#include <set>

#include "planning_io/plan/contour_stack.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/plan/plan_settings.h"
#include "planning_io/surface/shape_file.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

using Loop = std::vector<std::int32_t>;

/// The edges of the surface that belong to one triangle only, joined to closed loops. Empty for a closed surface.
std::vector<Loop> border_loops(const Shape& shape, const fs::path& file) {
    std::set<std::pair<std::int32_t, std::int32_t>> edges;  // directed
    for (const auto& t : shape.triangles)
        for (std::size_t c = 0; c < 3; ++c) edges.emplace(t[c], t[(c + 1) % 3]);
    std::map<std::int32_t, std::int32_t> next;
    for (const auto& [a, b] : edges)
        if (!edges.contains({b, a}) && !next.emplace(a, b).second)
            throw InputError(file, "has an edge that touches itself, which is no line to cut along",
                             "Repair the surface, or draw its outline as a closed curve.");
    std::vector<Loop> loops;
    while (!next.empty()) {
        Loop loop{next.begin()->first};
        for (auto at = next.begin(); at != next.end(); at = next.find(loop.back())) {
            loop.push_back(at->second);
            next.erase(at);
        }
        if (loop.front() != loop.back())
            throw InputError(file, "has triangles that are not turned alike",
                             "Repair the surface, or draw its outline as a closed curve.");
        loops.push_back(std::move(loop));
    }
    return loops;
}

class ShapePlan {
public:
    ShapePlan(const Shape& shape, Space space, const fs::path& file) : shape_(shape), space_(space), file_(file) {}

    void add(Plan& plan, const ShapeLine& line, const std::string& otherwise) const {
        const std::string name = line.kind.empty() && line.name.empty() ? otherwise : line.name;
        const auto refuse = [&](const std::string& problem) {
            throw InputError(file_, "\"" + name + "\" " + problem, "Correct this item of the plan.");
        };
        std::vector<Vector3d> points;
        for (const auto i : line.points) points.push_back(to_ct(shape_.points[static_cast<std::size_t>(i)], space_));
        const PlanSettings said(line.description, refuse);
        const double diameter_mm = said.length_mm("diameter_mm", kMaxDiameter_mm);
        if (line.kind == "trajectory") {
            if (points.size() != 2 || points[0] == points[1]) refuse("is not a trajectory of two points");
            plan.trajectories.push_back({name, points[0], points[1], diameter_mm, line.colour});
        } else if (line.kind == "borehole") {
            if (points.size() != 1) refuse("is not a borehole of one point");
            std::optional<Vector3d> axis;
            if (line.axis) axis = to_ct(*line.axis, space_);
            plan.boreholes.push_back(
                {name, points[0], axis, diameter_mm, said.length_mm("depth_mm", kMaxDepth_mm), line.colour});
        } else if (line.kind == "cut_plane") {
            add_plane(plan, name, points, line.colour, refuse);
        } else {
            add_line(plan, name, std::move(points), line.colour, refuse);
        }
    }

private:
    template <class Refuse>
    void add_line(Plan& plan, const std::string& name, std::vector<Vector3d> points,
                  const std::optional<Colour>& colour, const Refuse& refuse) const {
        OsteotomyLine o{name, std::move(points), false, colour};
        if (o.points_in_ct.size() < 2) refuse("is a single point, which is nothing to cut along");
        o.closed = o.points_in_ct.size() > 3 && o.points_in_ct.front() == o.points_in_ct.back();
        if (o.closed) o.points_in_ct.pop_back();
        for (std::size_t i = 1; i < o.points_in_ct.size(); ++i)
            if (o.points_in_ct[i] == o.points_in_ct[i - 1]) refuse("has two points at one place");
        plan.osteotomy_lines.push_back(std::move(o));
    }

    /// Its four corners, the first side along the first axis.
    template <class Refuse>
    void add_plane(Plan& plan, const std::string& name, const std::vector<Vector3d>& p,
                   const std::optional<Colour>& colour, const Refuse& refuse) const {
        if (p.size() != 5 || p[0] != p[4]) refuse("is not a plane of four corners");
        const Vector3d u = p[1] - p[0], v = p[2] - p[1];
        if (!(u.norm() > 1e-6) || !(v.norm() > 1e-6) || std::abs(u.normalized().dot(v.normalized())) > 1e-6 ||
            (p[0] + p[2] - p[1] - p[3]).norm() > 1e-6)
            refuse("is not a rectangle");
        plan.cut_planes.push_back({name, (p[0] + p[2]) / 2, u.normalized().cross(v.normalized()), u.normalized(),
                                   u.norm(), v.norm(), colour});
    }

    const Shape& shape_;
    Space space_;
    const fs::path& file_;
};

/// Contours of a solid on slices, which nobody means as lines to cut along.
void refuse_contour_stack(const Shape& shape, const fs::path& file) {
    std::vector<std::vector<Vector3d>> closed;
    for (const auto& line : shape.lines) {
        if (!line.kind.empty() || line.points.size() < 4 || line.points.front() != line.points.back()) continue;
        closed.emplace_back();
        for (const auto i : line.points) closed.back().push_back(shape.points[static_cast<std::size_t>(i)]);
    }
    if (const std::size_t heights = heights_of_contours(closed); heights >= kSolidHeights)
        throw InputError(
            file, fmt::format("has contours at {} heights: a solid, not a line to cut along", heights),
            "Export the cuts alone, as curves; the closed surface of a structure that must not be hurt is given to "
            "`planlight prepare --risk`.");
}

/// Lines of two points end to end are one line: most programs write curves so.
void join_segments(Shape& shape) {
    for (const auto& line : shape.lines)
        if (line.points.size() != 2 || !line.kind.empty() || !line.name.empty()) return;
    std::vector<ShapeLine> joined;
    for (auto& line : shape.lines) {
        if (!joined.empty() && joined.back().points.back() == line.points[0] &&
            joined.back().points.front() != joined.back().points.back())
            joined.back().points.push_back(line.points[1]);
        else
            joined.push_back(std::move(line));
    }
    shape.lines = std::move(joined);
}

}  // namespace

PlanImport read_shape_plan(const fs::path& file, const PlanImportSettings& settings) {
    Shape shape = welded(read_shape(file)).shape;
    PlanImport read;
    const Space space =
        space_of_plan(shape.space, settings, file, "Export it with its space (3D Slicer does: SPACE=LPS)", read);
    join_segments(shape);
    refuse_contour_stack(shape, file);
    const auto numbered = [&](std::size_t i, std::size_t count) {
        return count == 1 ? plan_name_of(file) : fmt::format("{} {}", plan_name_of(file), i + 1);
    };
    for (const auto& loop : border_loops(shape, file)) shape.lines.push_back({loop, {}, {}, {}, {}, {}});
    if (shape.lines.empty() && !shape.triangles.empty())
        throw InputError(
            file,
            fmt::format("is a closed surface of {} triangles, without an edge to cut along", shape.triangles.size()),
            "Draw the cut as a curve; a nerve or a vessel that must not be hurt is given to `planlight prepare "
            "--risk`, a surface to project on to `planlight prepare --surface`.");
    if (shape.lines.empty()) throw InputError(file, "holds no lines", "Export the plan's curves as lines.");
    for (std::size_t i = 0; i < shape.lines.size(); ++i)
        ShapePlan(shape, space, file).add(read.plan, shape.lines[i], numbered(i, shape.lines.size()));
    check_plan_numbers(read.plan, file);
    return read;
}

}  // namespace planlight
