#include "planning_io/plan/plan_markup.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "planning_io/files/header_text.h"
#include "planning_io/plan/plan_settings.h"
#include "planning_io/types/axes_along.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kMaxCoordinate_mm = 5000;
constexpr const char* kSaveAgain = "Save it again from 3D Slicer, in LPS and mm.";

/// How a markup's numbers become ct, mm.
struct MarkupSpace {
    double mm_per_unit = 1;
    double sign_xy = 1;
    Vector3d direction(const Vector3d& d) const { return {sign_xy * d.x(), sign_xy * d.y(), d.z()}; }
    Vector3d point(const Vector3d& p) const { return mm_per_unit * direction(p); }
};

MarkupSpace space_of(const JsonValue& markup, bool units_required) {
    MarkupSpace space;
    const std::string system = markup.at("coordinateSystem").text();
    if (system != "LPS" && system != "RAS")
        markup.at("coordinateSystem").refuse("is \"" + system + "\", neither \"LPS\" nor \"RAS\"", kSaveAgain);
    if (system == "RAS") space.sign_xy = -1;
    const auto units = markup.find("coordinateUnits");
    if (!units) {
        if (units_required) markup.refuse("has no \"coordinateUnits\"", kSaveAgain);
        return space;
    }
    const std::string unit =
        units->is_text() ? units->text() : (*units)[units->size() > 0 ? 0 : (units->refuse("is empty"), 0)].text();
    if (!units->is_text() && (units->size() != 3 || (*units)[1].text() != "UCUM"))
        units->refuse("is not a UCUM unit", kSaveAgain);
    if (unit != "mm" && unit != "um") units->refuse("is \"" + unit + "\", neither \"mm\" nor \"um\"", kSaveAgain);
    if (unit == "um") space.mm_per_unit = 1e-3;
    return space;
}

Vector3d point_in_ct(const JsonValue& position, const MarkupSpace& space) {
    const Vector3d p = space.point(position.vector3());
    if (p.cwiseAbs().maxCoeff() > kMaxCoordinate_mm)
        position.refuse("is more than 5 m from the origin", "Check the units of the plan.");
    return p;
}

/// A unit vector as it stands, or normalised when it is a rounded one.
Vector3d unit(const Vector3d& v, const JsonValue& where) {
    const double length = v.norm();
    if (!(std::abs(length - 1) < 1e-3)) where.refuse("does not hold directions of unit length");
    return std::abs(length - 1) < 1e-9 ? v : v / length;
}

Eigen::Matrix3d axes_in_ct(const JsonValue& orientation, const MarkupSpace& space) {
    const Eigen::Matrix3d file = orientation.matrix3();
    Eigen::Matrix3d axes;
    for (int column = 0; column < 3; ++column) axes.col(column) = unit(space.direction(file.col(column)), orientation);
    if ((axes.transpose() * axes - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > 1e-3 || axes.determinant() < 0)
        orientation.refuse("is not a rotation");
    return axes;
}

std::optional<Colour> colour_of(const JsonValue& markup) {
    const auto display = markup.find("display");
    if (!display) return std::nullopt;
    auto list = display->find("selectedColor");  // what 3D Slicer shows; "color" is that of unselected points
    if (!list) list = display->find("color");
    if (!list) return std::nullopt;
    if (list->size() != 3) list->refuse("must be three numbers");
    return Colour{static_cast<float>((*list)[0].number(0, 1)), static_cast<float>((*list)[1].number(0, 1)),
                  static_cast<float>((*list)[2].number(0, 1))};
}

PlanSettings settings_of(const JsonValue& point) {
    const auto description = point.find("description");
    return {description ? description->text() : std::string(),
            [point](const std::string& problem) { point.refuse(problem); }};
}

std::size_t count_points(const JsonValue& points, std::size_t least) {
    const std::size_t count = points.size();
    if (count < least)
        points.refuse(
            "holds " + counted(static_cast<long long>(count), "point") + ", fewer than " + std::to_string(least),
            "Place its points in 3D Slicer.");
    for (std::size_t i = 0; i < count; ++i)
        if (const auto status = points[i].find("positionStatus"); status && status->text() != "defined")
            points[i].refuse("is not placed (positionStatus \"" + status->text() + "\")",
                             "Place or delete the point in 3D Slicer.");
    return count;
}

/// The markup's own name, also an empty one; 3D Slicer leaves it out of files of one markup, which are named by it.
std::string name_of(const JsonValue& markup, const std::string& otherwise) {
    const auto name = markup.find("name");
    return name ? name->text() : otherwise;
}

void append_trajectory(Plan& plan, const JsonValue& markup, const MarkupSpace& space, const std::string& otherwise) {
    const JsonValue points = markup.at("controlPoints");
    if (count_points(points, 2) != 2) points.refuse("holds more than the two points of a line");
    Trajectory t;
    t.name = name_of(markup, otherwise);
    t.entry_in_ct = point_in_ct(points[0].at("position"), space);
    t.target_in_ct = point_in_ct(points[1].at("position"), space);
    t.diameter_mm = settings_of(points[0]).length_mm("diameter_mm", kMaxDiameter_mm);
    const double at_target_mm = settings_of(points[1]).length_mm("diameter_mm", kMaxDiameter_mm);
    if (t.diameter_mm > 0 && at_target_mm > 0 && t.diameter_mm != at_target_mm)
        points[1].refuse("describes another diameter_mm than the point before it");
    t.diameter_mm = std::max(t.diameter_mm, at_target_mm);
    t.colour = colour_of(markup);
    if (!(t.length_mm() > 1e-3))
        markup.refuse("(\"" + t.name + "\") is a line of no length", "Place its entry and its target apart.");
    plan.trajectories.push_back(std::move(t));
}

void append_boreholes(Plan& plan, const JsonValue& markup, const MarkupSpace& space, const std::string& otherwise) {
    const JsonValue points = markup.at("controlPoints");
    const std::size_t count = count_points(points, 0);
    for (std::size_t i = 0; i < count; ++i) {
        const auto settings = settings_of(points[i]);
        Borehole b;
        const auto label = points[i].find("label");
        b.name = label && !label->text().empty() ? label->text() : name_of(markup, otherwise);
        b.position_in_ct = point_in_ct(points[i].at("position"), space);
        b.diameter_mm = settings.length_mm("diameter_mm", kMaxDiameter_mm);
        b.depth_mm = settings.length_mm("depth_mm", kMaxDepth_mm);
        if (const auto axis = settings.text("axis")) {
            if (*axis != "z")
                points[i].refuse("describes axis=" + *axis +
                                 "; only axis=z (the third column of its orientation) is known");
            b.axis_in_ct = axes_in_ct(points[i].at("orientation"), space).col(2);
        }
        b.colour = colour_of(markup);
        plan.boreholes.push_back(std::move(b));
    }
}

void append_osteotomy_line(Plan& plan, const JsonValue& markup, const MarkupSpace& space, const std::string& otherwise,
                           bool closed) {
    const JsonValue points = markup.at("controlPoints");
    const std::size_t count = count_points(points, closed ? 3 : 2);
    OsteotomyLine line;
    line.name = name_of(markup, otherwise);
    line.closed = closed;
    line.colour = colour_of(markup);
    for (std::size_t i = 0; i < count; ++i) {
        line.points_in_ct.push_back(point_in_ct(points[i].at("position"), space));
        if (i > 0 && (line.points_in_ct[i] - line.points_in_ct[i - 1]).norm() == 0)
            points[i].refuse("is at the place of the point before it", "Delete the double point in 3D Slicer.");
    }
    plan.osteotomy_lines.push_back(std::move(line));
}

/// Two cuts that meet: an open line of three points whose name says the angle between them.
void append_angle(Plan& plan, const JsonValue& markup, const MarkupSpace& space, const std::string& otherwise) {
    if (markup.at("controlPoints").size() != 3)
        markup.at("controlPoints")
            .refuse("holds other than the three points of an angle", "Place its three points in 3D Slicer.");
    append_osteotomy_line(plan, markup, space, otherwise, false);
    OsteotomyLine& line = plan.osteotomy_lines.back();
    const Vector3d a = line.points_in_ct[0] - line.points_in_ct[1], b = line.points_in_ct[2] - line.points_in_ct[1];
    const double degrees = std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi;
    line.name += fmt::format("{}{:.1f} deg", line.name.empty() ? "" : " ", degrees);
}

void append_cut_plane(Plan& plan, const JsonValue& markup, const MarkupSpace& space, const std::string& otherwise) {
    CutPlane plane;
    plane.name = name_of(markup, otherwise);
    plane.origin_in_ct = point_in_ct(markup.at("center"), space);
    const Eigen::Matrix3d axes = axes_in_ct(markup.at("orientation"), space);
    plane.first_axis_in_ct = axes.col(0);
    plane.normal_in_ct = axes.col(2);
    const JsonValue size = markup.at("size");
    if (size.size() != 2 && size.size() != 3) size.refuse("must be three numbers");
    plane.width_mm = space.mm_per_unit * size[0].number(0, 1e7);
    plane.height_mm = space.mm_per_unit * size[1].number(0, 1e7);
    if (!(std::min(plane.width_mm, plane.height_mm) > 1e-3))
        size.refuse("is nothing along a side", "Give the plane a size in 3D Slicer.");
    if (const auto points = markup.find("controlPoints")) count_points(*points, 0);
    if (const auto bounds = markup.find("planeBounds"); bounds && bounds->size() == 4)
        if (std::abs((*bounds)[0].number() + (*bounds)[1].number()) > 1e-3 ||
            std::abs((*bounds)[2].number() + (*bounds)[3].number()) > 1e-3)
            bounds->refuse("is not centred on the plane's centre", "Give the plane a fixed size in 3D Slicer.");
    plane.colour = colour_of(markup);
    plan.cut_planes.push_back(std::move(plane));
}

Json base(const char* type, const std::string& name, const std::optional<Colour>& colour) {
    Json markup{
        {"type", type}, {"name", name}, {"coordinateSystem", "LPS"}, {"coordinateUnits", "mm"}, {"locked", true}};
    if (colour) {
        const Json list = Json::array({(*colour)[0], (*colour)[1], (*colour)[2]});
        markup["display"] = Json{{"visibility", true}, {"color", list}, {"selectedColor", list}};
    }
    return markup;
}

Json control_point(int number, const std::string& label, const Vector3d& position, const std::string& description) {
    return Json{{"id", std::to_string(number)},
                {"label", label},
                {"description", description},
                {"position", to_json(position)},
                {"selected", true},
                {"locked", true},
                {"visibility", true},
                {"positionStatus", "defined"}};
}

}  // namespace

void append_markup(Plan& plan, const JsonValue& markup, bool units_required, const std::string& otherwise) {
    const std::string type = markup.at("type").text();
    const auto refuse = [&](const std::string& problem, const std::string& remedy) {
        markup.refuse("(\"" + name_of(markup, otherwise) + "\") is of type \"" + type + "\", " + problem, remedy);
    };
    if (type == "ROI")
        refuse("a box, which is nothing to cut or to drill",
               "Draw its outline as a closed curve, or its sides as planes, in 3D Slicer.");
    const bool line = type == "Line", points = type == "Fiducial", angle = type == "Angle", plane = type == "Plane";
    const bool closed = type == "ClosedCurve";
    if (!line && !points && !angle && !plane && !closed && type != "Curve")
        refuse("which means nothing in a plan",
               "Keep only lines, angles, points, curves and planes in the plan's file.");
    const MarkupSpace space = space_of(markup, units_required);
    if (line)
        append_trajectory(plan, markup, space, otherwise);
    else if (points)
        append_boreholes(plan, markup, space, otherwise);
    else if (angle)
        append_angle(plan, markup, space, otherwise);
    else if (plane)
        append_cut_plane(plan, markup, space, otherwise);
    else
        append_osteotomy_line(plan, markup, space, otherwise, closed);
}

Json markup_of(const Trajectory& t) {
    Json markup = base("Line", t.name, t.colour);
    markup["controlPoints"] = Json::array(
        {control_point(1, "entry", t.entry_in_ct, description_of(t)), control_point(2, "target", t.target_in_ct, "")});
    return markup;
}

Json markup_of(const Borehole& b) {
    Json markup = base("Fiducial", b.name, b.colour);
    Json point = control_point(1, b.name, b.position_in_ct, description_of(b));
    if (b.axis_in_ct) {
        point["description"] = point["description"].get<std::string>() + " axis=z";
        point["orientation"] = to_json(axes_along(*b.axis_in_ct));
    }
    markup["controlPoints"] = Json::array({std::move(point)});
    return markup;
}

Json markup_of(const OsteotomyLine& line) {
    Json markup = base(line.closed ? "ClosedCurve" : "Curve", line.name, line.colour);
    Json points = Json::array();
    for (const auto& p : line.points_in_ct) {
        const int number = static_cast<int>(points.size()) + 1;
        points.push_back(control_point(number, std::to_string(number), p, ""));
    }
    markup["controlPoints"] = std::move(points);
    return markup;
}

Json markup_of(const CutPlane& c) {
    Json markup = base("Plane", c.name, c.colour);
    Eigen::Matrix3d axes;
    axes.col(0) = c.first_axis_in_ct;
    axes.col(1) = c.normal_in_ct.cross(c.first_axis_in_ct);
    axes.col(2) = c.normal_in_ct;
    Eigen::Matrix4d object_to_base = Eigen::Matrix4d::Identity(), base_to_node = Eigen::Matrix4d::Identity();
    base_to_node.topLeftCorner<3, 3>() = axes;
    base_to_node.topRightCorner<3, 1>() = c.origin_in_ct;
    markup["planeType"] = "PointNormal";
    markup["sizeMode"] = "absolute";
    markup["center"] = to_json(c.origin_in_ct);
    markup["normal"] = to_json(c.normal_in_ct);
    markup["size"] = Json::array({c.width_mm, c.height_mm, 0.0});
    markup["planeBounds"] = Json::array({-c.width_mm / 2, c.width_mm / 2, -c.height_mm / 2, c.height_mm / 2});
    markup["objectToBase"] = to_json(RigidTransform(object_to_base));
    markup["baseToNode"] = to_json(RigidTransform(base_to_node));
    markup["orientation"] = to_json(axes);
    markup["controlPoints"] = Json::array({control_point(1, c.name, c.origin_in_ct, "")});
    return markup;
}

}  // namespace planlight
