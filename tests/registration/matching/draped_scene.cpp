#include "tests/registration/matching/draped_scene.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/registration/matching/drape_dresser.h"
#include "tests/registration/matching/matching_scenes.h"
#include "tests/registration/matching/ray_grid.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

constexpr double kDistance_mm = 900, kBaseline_mm = 220, kSteepest_cosine = 0.26;

ViewFrame frame_of(const TrialSurface& head, const DrapedSceneSettings& s) {
    ViewFrame view;
    const Vector3d back = s.from_in_ct.normalized();
    const Vector3d level =
        back.cross(Vector3d::UnitZ()).norm() > 0.1 ? back.cross(Vector3d::UnitZ()).normalized() : Vector3d::UnitX();
    const Vector3d right = std::cos(s.roll) * level + std::sin(s.roll) * back.cross(level);
    view.ct_from_view.linear() << right, back.cross(right), back;
    const auto hit = head.first_hit(s.face_in_ct + 500 * back, -back);
    view.ct_from_view.translation() = hit ? hit->p_in_ct : s.face_in_ct;
    return view;
}

/// What each ray met; `skin`: of those that met, the head.
struct Grid : RayGrid {
    std::vector<char> skin;
};

struct Seen {
    const TrialSurface& head;
    const TrialSurface& things;
    bool between(const Vector3d& p, const Vector3d& eye) const {
        const Vector3d way = (eye - p).normalized(), start = p + 0.6 * way;
        const double far = (eye - start).norm();
        for (const TrialSurface* surface : {&head, &things}) {
            const auto hit = surface->first_hit(start, way);
            if (hit && (hit->p_in_ct - start).norm() < far) return true;
        }
        return false;
    }
};

Grid cast(const Seen& seen, const ViewFrame& view, double width_mm, int columns, bool without_head) {
    Grid grid;
    grid.columns = columns;
    grid.rows = columns * 3 / 4;
    grid.spacing_mm = width_mm / columns;
    const Vector3d eye = view.to_ct({0, 0, kDistance_mm});
    const Vector3d cameras[2] = {view.to_ct({-kBaseline_mm, 0, kDistance_mm}),
                                 view.to_ct({kBaseline_mm, 0, kDistance_mm})};
    for (int j = 0; j < grid.rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const Vector3d through((i + 0.5 - 0.5 * columns) * grid.spacing_mm,
                                   (j + 0.5 - 0.5 * grid.rows) * grid.spacing_mm, 0);
            const Vector3d d = (view.to_ct(through) - eye).normalized();
            const auto thing = seen.things.first_hit(eye, d);
            const auto skin = without_head ? std::nullopt : seen.head.first_hit(eye, d);
            const bool is_skin = skin && (!thing || (skin->p_in_ct - eye).norm() < (thing->p_in_ct - eye).norm());
            const auto& hit = is_skin ? skin : thing;
            const bool met = hit && (!is_skin || hit->flag == kSkin) &&
                             std::abs(hit->normal_in_ct.dot(d)) > kSteepest_cosine &&
                             !(seen.between(hit->p_in_ct, cameras[0]) && seen.between(hit->p_in_ct, cameras[1]));
            grid.direction.push_back(d);
            grid.met.push_back(met);
            grid.skin.push_back(met && is_skin);
            grid.p.push_back(met ? hit->p_in_ct : Vector3d::Zero());
        }
    return grid;
}

void set_truth(const Grid& grid, const std::vector<char>& of_interest, const Vector3d& from_in_ct, DrapedScene& scene) {
    double count = 0;
    for (std::size_t i = 0; i < grid.p.size(); ++i)
        if (of_interest[i]) scene.scan.middle_in_ct += grid.p[i], ++count;
    scene.scan.middle_in_ct /= count;
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < grid.p.size(); ++i)
        if (of_interest[i])
            squares +=
                (grid.p[i] - scene.scan.middle_in_ct) * (grid.p[i] - scene.scan.middle_in_ct).transpose() / count;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(squares);
    scene.skin_width_mm = std::sqrt(12 * std::max(axes.eigenvalues()[1], 0.));
    scene.scan.targets_in_ct = targets_round(scene.scan.middle_in_ct - 60 * from_in_ct.normalized());
}

}  // namespace

const std::vector<Draping>& drapings() {
    static const std::vector<Draping> all{{"sheet behind", true},     {"wrapped, with a hole", true},
                                          {"hand and forearm", true}, {"tubes", true},
                                          {"towel rolls", false},     {"sheet touching the brow", false},
                                          {"crumpled cloth", false},  {"table edge, retractors", false}};
    return all;
}

DrapedScene draped_scene(const TrialSurface& head, const DrapedSceneSettings& settings) {
    DrapedScene scene;
    const ViewFrame view = frame_of(head, settings);
    const HeadHeights heights(head, view);
    TriangleMesh things = things_round(heights, settings);
    for (Vector3d& p : things.vertices_in_ct) p = view.to_ct(p);
    const TrialSurface dress(std::move(things));
    Grid grid = cast({head, dress}, view, settings.window_mm, static_cast<int>(std::sqrt(settings.points * 4. / 3)),
                     settings.without_head);
    const std::vector<char>& of_interest = settings.without_head ? grid.met : grid.skin;
    if (std::count(of_interest.begin(), of_interest.end(), 1) < 400) return scene;
    set_truth(grid, of_interest, settings.from_in_ct, scene);
    std::mt19937 random(settings.seed);
    DepthSpoiler spoiler(settings.noise_mm, settings.stray_share, random);
    TrialScan& scan = scene.scan;
    for (std::size_t i = 0; i < grid.p.size(); ++i) {
        if (!grid.met[i]) continue;
        const DepthSpoiler::Spoilt spoilt = spoiler.next();
        grid.p[i] += spoilt.mm * grid.direction[i];
        ++(spoilt.stray ? scan.stray_points : grid.skin[i] ? scan.bare_points : scan.drape_points);
    }
    scan.rig_from_ct = random_pose(settings.seed);
    scan.viewpoint_in_rig = scan.rig_from_ct * view.to_ct({0, 0, kDistance_mm});
    for (std::size_t i = 0; i < grid.p.size(); ++i) {
        if (!grid.met[i]) continue;
        scan.cloud.points_in_rig.emplace_back(scan.rig_from_ct * grid.p[i]);
        scan.cloud.normals_in_rig.emplace_back(scan.rig_from_ct.linear() * grid.normal_at(i));
        scene.is_skin.push_back(grid.skin[i]);
    }
    return scene;
}

}  // namespace planlight::test
