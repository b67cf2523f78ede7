#include "planning_io/plan_markup.h"

#include <charconv>
#include <cmath>
#include <map>
#include <sstream>

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kMaxCoordinate_mm = 5000;
constexpr const char* kSaveAgain = "Save it again from 3D Slicer, in LPS and mm.";

/// How a markup's numbers become ct, mm.
struct Space {
    double mm_per_unit = 1;
    double sign_xy = 1;
    Vector3d direction(const Vector3d& d) const { return {sign_xy * d.x(), sign_xy * d.y(), d.z()}; }
    Vector3d point(const Vector3d& p) const { return mm_per_unit * direction(p); }
};

Space space_of(const JsonValue& markup, bool units_required) {
    Space space;
    const std::string system = markup.at("coordinateSystem").text();
    if (system != "LPS" && system != "RAS") markup.at("coordinateSystem").refuse("is \"" + system + "\", neither \"LPS\" nor \"RAS\"", kSaveAgain);
    if (system == "RAS") space.sign_xy = -1;
    const auto units = markup.find("coordinateUnits");
    if (!units) {
        if (units_required) markup.refuse("has no \"coordinateUnits\"", kSaveAgain);
        return space;
    }
    const std::string unit = units->is_text() ? units->text() : (*units)[units->size() > 0 ? 0 : (units->refuse("is empty"), 0)].text();
    if (!units->is_text() && (units->size() != 3 || (*units)[1].text() != "UCUM")) units->refuse("is not a UCUM unit", kSaveAgain);
    if (unit != "mm" && unit != "um") units->refuse("is \"" + unit + "\", neither \"mm\" nor \"um\"", kSaveAgain);
    if (unit == "um") space.mm_per_unit = 1e-3;
    return space;
}

Vector3d point_in_ct(const JsonValue& position, const Space& space) {
    const Vector3d p = space.point(position.vector3());
    if (p.cwiseAbs().maxCoeff() > kMaxCoordinate_mm) position.refuse("is more than 5 m from the origin", "Check the units of the plan.");
    return p;
}

/// A unit vector as it stands, or normalised when it is a rounded one.
Vector3d unit(const Vector3d& v, const JsonValue& where) {
    const double length = v.norm();
    if (!(std::abs(length - 1) < 1e-3)) where.refuse("does not hold directions of unit length");
    return std::abs(length - 1) < 1e-9 ? v : v / length;
}

Eigen::Matrix3d axes_in_ct(const JsonValue& orientation, const Space& space) {
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
    return Colour{static_cast<float>((*list)[0].number(0, 1)), static_cast<float>((*list)[1].number(0, 1)), static_cast<float>((*list)[2].number(0, 1))};
}

/// The "key=value" words of a description; other words are the surgeon's own.
std::map<std::string, std::string> settings_of(const JsonValue& point) {
    std::map<std::string, std::string> settings;
    const auto description = point.find("description");
    if (!description) return settings;
    std::istringstream words(description->text());
    for (std::string word; words >> word;)
        if (const auto equals = word.find('='); equals != std::string::npos) settings[word.substr(0, equals)] = word.substr(equals + 1);
    return settings;
}

double length_setting(const std::map<std::string, std::string>& settings, const std::string& key, double most_mm, const JsonValue& point) {
    const auto setting = settings.find(key);
    if (setting == settings.end()) return 0;
    double value = 0;
    const char *begin = setting->second.data(), *end = begin + setting->second.size();
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (error != std::errc() || stop != end || !(value >= 0) || value > most_mm)
        point.refuse("describes " + key + "=" + setting->second + ", not a number from 0 to " + Json(most_mm).dump());
    return value;
}

std::size_t count_points(const JsonValue& points, std::size_t least) {
    const std::size_t count = points.size();
    if (count < least) points.refuse("holds " + std::to_string(count) + " points, fewer than " + std::to_string(least), "Place its points in 3D Slicer.");
    for (std::size_t i = 0; i < count; ++i)
        if (const auto status = points[i].find("positionStatus"); status && status->text() != "defined")
            points[i].refuse("is not placed (positionStatus \"" + status->text() + "\")", "Place or delete the point in 3D Slicer.");
    return count;
}

std::string name_of(const JsonValue& markup, const char* otherwise) {
    const auto name = markup.find("name");
    const std::string text = name ? name->text() : std::string();
    return text.empty() ? otherwise : text;
}

void append_trajectory(Plan& plan, const JsonValue& markup, const Space& space) {
    const JsonValue points = markup.at("controlPoints");
    if (count_points(points, 2) != 2) points.refuse("holds more than the two points of a line");
    Trajectory t;
    t.name = name_of(markup, "Trajectory");
    t.entry_in_ct = point_in_ct(points[0].at("position"), space);
    t.target_in_ct = point_in_ct(points[1].at("position"), space);
    t.diameter_mm = length_setting(settings_of(points[0]), "diameter_mm", 100, points[0]);
    t.colour = colour_of(markup);
    if (!(t.length_mm() > 1e-3)) markup.refuse("(\"" + t.name + "\") is a line of no length", "Place its entry and its target apart.");
    plan.trajectories.push_back(std::move(t));
}

void append_boreholes(Plan& plan, const JsonValue& markup, const Space& space) {
    const JsonValue points = markup.at("controlPoints");
    const std::size_t count = count_points(points, 0);
    for (std::size_t i = 0; i < count; ++i) {
        const auto settings = settings_of(points[i]);
        Borehole b;
        const auto label = points[i].find("label");
        b.name = label && !label->text().empty() ? label->text() : name_of(markup, "Borehole");
        b.position_in_ct = point_in_ct(points[i].at("position"), space);
        b.diameter_mm = length_setting(settings, "diameter_mm", 100, points[i]);
        b.depth_mm = length_setting(settings, "depth_mm", 300, points[i]);
        if (const auto axis = settings.find("axis"); axis != settings.end()) {
            if (axis->second != "z") points[i].refuse("describes axis=" + axis->second + "; only axis=z (the third column of its orientation) is known");
            b.axis_in_ct = axes_in_ct(points[i].at("orientation"), space).col(2);
        }
        b.colour = colour_of(markup);
        plan.boreholes.push_back(std::move(b));
    }
}

void append_osteotomy_line(Plan& plan, const JsonValue& markup, const Space& space, bool closed) {
    const JsonValue points = markup.at("controlPoints");
    const std::size_t count = count_points(points, closed ? 3 : 2);
    OsteotomyLine line;
    line.name = name_of(markup, "Osteotomy line");
    line.closed = closed;
    line.colour = colour_of(markup);
    for (std::size_t i = 0; i < count; ++i) {
        line.points_in_ct.push_back(point_in_ct(points[i].at("position"), space));
        if (i > 0 && (line.points_in_ct[i] - line.points_in_ct[i - 1]).norm() == 0)
            points[i].refuse("is at the place of the point before it", "Delete the double point in 3D Slicer.");
    }
    plan.osteotomy_lines.push_back(std::move(line));
}

void append_cut_plane(Plan& plan, const JsonValue& markup, const Space& space) {
    CutPlane plane;
    plane.name = name_of(markup, "Cut plane");
    plane.origin_in_ct = point_in_ct(markup.at("center"), space);
    const Eigen::Matrix3d axes = axes_in_ct(markup.at("orientation"), space);
    plane.first_axis_in_ct = axes.col(0);
    plane.normal_in_ct = axes.col(2);
    const JsonValue size = markup.at("size");
    if (size.size() != 2 && size.size() != 3) size.refuse("must be three numbers");
    plane.width_mm = space.mm_per_unit * size[0].number(0, 1e7);
    plane.height_mm = space.mm_per_unit * size[1].number(0, 1e7);
    if (const auto bounds = markup.find("planeBounds"); bounds && bounds->size() == 4)
        if (std::abs((*bounds)[0].number() + (*bounds)[1].number()) > 1e-3 || std::abs((*bounds)[2].number() + (*bounds)[3].number()) > 1e-3)
            bounds->refuse("is not centred on the plane's centre", "Give the plane a fixed size in 3D Slicer.");
    plane.colour = colour_of(markup);
    plan.cut_planes.push_back(std::move(plane));
}

Json base(const char* type, const std::string& name, const std::optional<Colour>& colour) {
    Json markup{{"type", type}, {"name", name}, {"coordinateSystem", "LPS"}, {"coordinateUnits", "mm"}, {"locked", true}};
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

/// Columns: two axes across, then `z` as it stands.
Eigen::Matrix3d orientation_with_z(const Vector3d& z) {
    Eigen::Matrix3d axes;
    axes.col(2) = z;
    axes.col(0) = z.unitOrthogonal();
    axes.col(1) = z.cross(axes.col(0));
    return axes;
}

}  // namespace

void append_markup(Plan& plan, const JsonValue& markup, bool units_required) {
    const std::string type = markup.at("type").text();
    const bool closed = type == "ClosedCurve";
    if (type != "Line" && type != "Fiducial" && type != "Curve" && !closed && type != "Plane")
        markup.refuse("(\"" + name_of(markup, "no name") + "\") is of type \"" + type + "\", which means nothing in a plan",
                      "Keep only lines, points, curves and planes in the plan's file.");
    const Space space = space_of(markup, units_required);
    if (type == "Line") append_trajectory(plan, markup, space);
    if (type == "Fiducial") append_boreholes(plan, markup, space);
    if (type == "Curve" || closed) append_osteotomy_line(plan, markup, space, closed);
    if (type == "Plane") append_cut_plane(plan, markup, space);
}

Json markup_of(const Trajectory& t) {
    Json markup = base("Line", t.name, t.colour);
    const std::string description = t.diameter_mm > 0 ? "diameter_mm=" + Json(t.diameter_mm).dump() : "";
    markup["controlPoints"] = Json::array({control_point(1, "entry", t.entry_in_ct, description), control_point(2, "target", t.target_in_ct, "")});
    return markup;
}

Json markup_of(const Borehole& b) {
    Json markup = base("Fiducial", b.name, b.colour);
    Json point = control_point(1, b.name, b.position_in_ct, "diameter_mm=" + Json(b.diameter_mm).dump() + " depth_mm=" + Json(b.depth_mm).dump());
    if (b.axis_in_ct) {
        point["description"] = point["description"].get<std::string>() + " axis=z";
        point["orientation"] = to_json(orientation_with_z(*b.axis_in_ct));
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
