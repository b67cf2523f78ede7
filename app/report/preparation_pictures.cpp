#include "app/report/preparation_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/report/slice_picture.h"
#include "app/windows/scene_view.h"
#include "planning_io/types/error.h"

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

std::string place_of(SliceKind kind, const Vector3d& p) {
    if (kind == SliceKind::axial) return fmt::format("{} {:.1f} mm", p.z() < 0 ? "I" : "S", std::abs(p.z()));
    if (kind == SliceKind::coronal) return fmt::format("{} {:.1f} mm", p.y() < 0 ? "A" : "P", std::abs(p.y()));
    return fmt::format("{} {:.1f} mm", p.x() < 0 ? "R" : "L", std::abs(p.x()));
}

std::vector<ReportPicture> slices_at(const Volume& volume, const Case& the_case, const Vector3d& at) {
    struct Kind {
        SliceKind kind;
        const char *name, *seen;
    };
    constexpr Kind kKinds[] = {{SliceKind::axial, "Axial", "from the feet"},
                               {SliceKind::coronal, "Coronal", "from the front"},
                               {SliceKind::sagittal, "Sagittal", "from the left"}};
    std::vector<ReportPicture> pictures;
    for (const auto& [kind, name, seen] : kKinds)
        pictures.push_back({name, fmt::format("at {}, seen {}", place_of(kind, at), seen),
                            slice_picture(volume, the_case.skin, the_case.plan, kind, at)});
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
                               {"From above", 0, 1.5}};
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
    pictures.middle_slices = slices_at(volume, the_case, middle_of(the_case.skin));
    if (!the_case.plan.empty()) pictures.plan_slices = slices_at(volume, the_case, point_of_interest(the_case));
}

void add_views(const Case& the_case, const PlanDrawing& drawing, PreparationPictures& pictures) {
    try {
        pictures.views = views_of(the_case, drawing);
    } catch (const Error& error) {  // no renderer, or no memory for it
        pictures.no_views = fmt::format("the report has no views of the head: {}", error.what());
    }
}

}  // namespace planlight
