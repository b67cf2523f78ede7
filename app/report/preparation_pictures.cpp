#include "app/report/preparation_pictures.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "app/report/slice_picture.h"
#include "app/windows/scene_view.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"

namespace planlight {

using Eigen::Vector3d;

namespace {

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
    scene.skin = std::make_shared<TriangleMesh>(the_case.skin);
    scene.plan = std::make_shared<PlanDrawing>(drawing);
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
    std::vector<RgbImage> drawn = render_views(scene, views, 520, 520);
    std::vector<ReportPicture> pictures;
    for (std::size_t i = 0; i < drawn.size(); ++i) pictures.push_back({kSides[i].name, "", std::move(drawn[i])});
    return pictures;
}

}  // namespace

Vector3d point_of_interest(const Case& the_case) {
    if (!the_case.plan.trajectories.empty() && the_case.plan.trajectories.front().target_in_ct.allFinite())
        return the_case.plan.trajectories.front().target_in_ct;
    const auto points = points_of(the_case.plan);
    if (!points.empty() && mean_of(points).allFinite()) return mean_of(points);
    return the_case.skin.vertices_in_ct.empty() ? Vector3d::Zero() : mean_of(the_case.skin.vertices_in_ct);
}

PreparationPictures preparation_pictures(const Volume& volume, const Case& the_case, const PlanDrawing& drawing) {
    PreparationPictures pictures;
    pictures.middle_slices = slices_at(volume, the_case, middle_of(the_case.skin));
    if (!the_case.plan.empty()) pictures.plan_slices = slices_at(volume, the_case, point_of_interest(the_case));
    try {
        pictures.views = views_of(the_case, drawing);
    } catch (const DeviceError& error) {
        pictures.no_views = fmt::format("the report has no views of the head: {}", error.what());
    }
    return pictures;
}

}  // namespace planlight
