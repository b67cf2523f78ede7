#include "app/report/preparation_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/report/slice_picture.h"
#include "app/windows/scene_view.h"
#include "planning_io/types/error.h"
#include "projection/skin_place.h"

namespace planlight {

using Eigen::Vector3d;

namespace {

constexpr int kView_px = 440;  // 45 mm of paper at 250 a inch

Vector3d mean_of(const std::vector<Vector3d>& points) {
    Vector3d sum = Vector3d::Zero();
    for (const auto& p : points) sum += p;
    return sum / static_cast<double>(points.size());
}

Vector3d middle_of(const TriangleMesh& skin) {
    if (skin.vertices_in_ct.empty()) return Vector3d::Zero();
    Vector3d low = skin.vertices_in_ct.front(), high = low;
    for (const auto& p : skin.vertices_in_ct) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    return (low + high) / 2;
}

/// Where a slice lies, from the middle of the skin: a volume's own zero may lie at its corner, and would tell a wrong
/// side.
std::string place_of(SliceKind kind, const Vector3d& from_middle) {
    const auto said = [](double mm, const char* minus, const char* plus) {
        return std::abs(mm) < 0.5 ? std::string("through the middle")
                                  : fmt::format("{:.0f} mm {} the middle", std::abs(mm), mm < 0 ? minus : plus);
    };
    if (kind == SliceKind::axial) return said(from_middle.z(), "below", "above");
    if (kind == SliceKind::coronal) return said(from_middle.y(), "before", "behind");
    return said(from_middle.x(), "right of", "left of");
}

/// The plan as slices show it: each hole with the way it is drilled.
Plan with_axes(Plan plan, const TriangleMesh& skin) {
    if (skin.triangles.empty() || std::ranges::all_of(plan.boreholes, has_axis)) return plan;
    const SkinSurface surface(skin);
    for (Borehole& hole : plan.boreholes) hole.axis_in_ct = drilling_direction(hole, surface);
    return plan;
}

std::vector<ReportPicture> slices_at(const Volume& volume, const Case& the_case, const Plan& plan, const Vector3d& at) {
    const Vector3d middle = middle_of(the_case.skin);
    struct Kind {
        SliceKind kind;
        const char *name, *seen;
    };
    constexpr Kind kKinds[] = {{SliceKind::axial, "Axial", "from the feet"},
                               {SliceKind::coronal, "Coronal", "from the front"},
                               {SliceKind::sagittal, "Sagittal", "from the left"}};
    std::vector<ReportPicture> pictures;
    for (const auto& [kind, name, seen] : kKinds)
        pictures.push_back({name, fmt::format("{}, seen {}", place_of(kind, at - middle), seen),
                            slice_picture(volume, the_case.skin, plan, kind, at)});
    return pictures;
}

/// The skin without the plan's labels would be bare: all of the drawing is shown, on white.
std::vector<ReportPicture> views_of(const Case& the_case, const PlanDrawing& drawing) {
    SceneModel scene;
    scene.on_paper = true;
    scene.skin = {std::shared_ptr<void>(), &the_case.skin};  // theirs: they outlive the scene
    scene.plan = {std::shared_ptr<void>(), &drawing};
    if (!the_case.plan.risk_structures.empty())
        scene.risk_structures = {std::shared_ptr<void>(), &the_case.plan.risk_structures};
    constexpr double kQuarter = std::numbers::pi / 2;
    struct Side {
        const char* name;
        double azimuth, elevation;
    };
    constexpr Side kSides[] = {{"From the front", 0, 0.15},
                               {"From the right", kQuarter, 0.15},
                               {"From behind", 2 * kQuarter, 0.15},
                               {"From the left", 3 * kQuarter, 0.15},
                               {"From above", 0, 1.5},
                               {"From below", 0, -1.5}};
    std::vector<SceneView> views;
    for (const auto& side : kSides) {
        views.emplace_back();
        views.back().azimuth = side.azimuth;
        views.back().elevation = side.elevation;
    }
    std::vector<RgbImage> drawn = render_views(scene, views, kView_px, kView_px);
    std::vector<ReportPicture> pictures;
    for (std::size_t i = 0; i < drawn.size(); ++i) pictures.push_back({kSides[i].name, "", std::move(drawn[i])});
    return pictures;
}

}  // namespace

Vector3d point_of_interest(const Case& the_case) {
    std::vector<Vector3d> points;
    for (const auto& t : the_case.plan.trajectories) points.push_back(t.entry_in_ct);
    for (const auto& b : the_case.plan.boreholes) points.push_back(b.position_in_ct);
    for (const auto& line : the_case.plan.osteotomy_lines)
        points.insert(points.end(), line.points_in_ct.begin(), line.points_in_ct.end());
    for (const auto& c : the_case.plan.cut_planes) points.push_back(c.origin_in_ct);
    std::erase_if(points, [](const Vector3d& p) { return !p.allFinite(); });
    if (points.empty()) return middle_of(the_case.skin);
    const Vector3d middle = mean_of(points);
    return *std::min_element(points.begin(), points.end(), [&](const Vector3d& a, const Vector3d& b) {
        return (a - middle).squaredNorm() < (b - middle).squaredNorm();
    });
}

void add_slices(const Volume& volume, const Case& the_case, PreparationPictures& pictures) {
    const Plan plan = with_axes(the_case.plan, the_case.skin);
    pictures.middle_slices = slices_at(volume, the_case, plan, middle_of(the_case.skin));
    if (!plan.empty()) pictures.plan_slices = slices_at(volume, the_case, plan, point_of_interest(the_case));
}

void add_views(const Case& the_case, const PlanDrawing& drawing, PreparationPictures& pictures) {
    try {
        pictures.views = views_of(the_case, drawing);
    } catch (const Error& error) {  // no renderer, or no memory for it
        pictures.no_views = fmt::format("the report has no views of the head: {}", error.what());
    }
}

}  // namespace planlight
