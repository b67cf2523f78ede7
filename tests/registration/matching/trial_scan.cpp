#include "tests/registration/matching/trial_scan.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/registration/matching/matching_scenes.h"
#include "tests/registration/matching/moved_skin.h"
#include "tests/registration/matching/ray_grid.h"

namespace planlight::test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kDistance_mm = 900, kSteepest_cosine = 0.26;

/// The window as a pinhole: rays from the eye through a plane at the head's middle.
struct Window {
    Vector3d eye, middle, right, down;
    double width_mm = 0;

    Window(const TrialSurface& surface, const TrialScanSettings& s) : width_mm(s.width_mm) {
        const Vector3d back = s.from_in_ct.normalized();
        const Vector3d level =
            back.cross(Vector3d::UnitZ()).norm() > 0.1 ? back.cross(Vector3d::UnitZ()).normalized() : Vector3d::UnitX();
        right = std::cos(s.roll) * level + std::sin(s.roll) * back.cross(level);
        down = right.cross(back);
        middle = surface.middle_in_ct() + s.aside_mm.x() * right + s.aside_mm.y() * down;
        eye = middle + kDistance_mm * back;
    }
    double height_mm() const { return 0.75 * width_mm; }
    /// `at` from -1/2 to 1/2 across and down.
    Vector3d ray(const Vector2d& at) const {
        return (middle + at.x() * width_mm * right + at.y() * height_mm() * down - eye).normalized();
    }
};

/// What each ray met.
struct Grid : RayGrid {
    std::vector<Vector2d> window;  ///< of each ray
    std::vector<Vector3d> normal;  ///< of the surface, in ct
};

Grid cast(const TrialSurface& surface, const Window& window, int columns) {
    Grid grid;
    grid.columns = columns;
    grid.rows = std::max(1, columns * 3 / 4);
    grid.spacing_mm = window.width_mm / columns;
    for (int j = 0; j < grid.rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const Vector2d at((i + 0.5) / columns - 0.5, (j + 0.5) / grid.rows - 0.5);
            const Vector3d direction = window.ray(at);
            const auto hit = surface.first_hit(window.eye, direction);
            const bool skin = hit && hit->flag == kSkin && hit->normal_in_ct.dot(direction) < -kSteepest_cosine;
            grid.window.push_back(at);
            grid.direction.push_back(direction);
            grid.met.push_back(skin);
            grid.p.push_back(skin ? hit->p_in_ct : Vector3d::Zero());
            grid.normal.push_back(skin ? hit->normal_in_ct : Vector3d::Zero());
        }
    return grid;
}

/// The skin's movement acts on the head, before it is seen.
void move_skin(Grid& grid, const TrialScanSettings& settings) {
    if (settings.movement.empty() || !(settings.movement_mm > 0)) return;
    const auto skin = grid.those_that_met();
    PointCloud cloud;
    for (const auto i : skin) {
        cloud.points_in_rig.push_back(grid.p[i]);
        cloud.normals_in_rig.push_back(grid.normal[i]);
    }
    cloud = with_moved_skin(cloud, settings.movement, settings.movement_mm, settings.seed + 7);
    for (std::size_t k = 0; k < skin.size(); ++k) grid.p[skin[k]] = cloud.points_in_rig[k];
}

/// A cloth over one side of the window: a surface of second degree over the skin below it, lifted, with folds.
std::vector<char> lay_drape(Grid& grid, const Window& window, const TrialScanSettings& settings, std::mt19937& random) {
    std::vector<char> draped(grid.p.size(), 0);
    if (!(settings.drape_share > 0)) return draped;
    std::uniform_real_distribution<double> unit;
    const double side = 2 * std::numbers::pi * unit(random), fold_side = 2 * std::numbers::pi * unit(random);
    const double fold_mm = 20 + 40 * unit(random), phase = 2 * std::numbers::pi * unit(random);
    auto skin = grid.those_that_met();
    const auto across = [&](std::size_t i) { return grid.window[i].dot(Vector2d(std::cos(side), std::sin(side))); };
    const auto under = static_cast<std::size_t>(settings.drape_share * static_cast<double>(skin.size()));
    if (under < 50) return draped;
    std::nth_element(skin.begin(), skin.begin() + static_cast<std::ptrdiff_t>(under), skin.end(),
                     [&](auto a, auto b) { return across(a) < across(b); });
    skin.resize(under);
    Eigen::MatrixXd A(static_cast<Eigen::Index>(under), 6);
    Eigen::VectorXd depth(static_cast<Eigen::Index>(under));
    for (std::size_t k = 0; k < under; ++k) {
        const double x = grid.window[skin[k]].x(), y = grid.window[skin[k]].y();
        A.row(static_cast<Eigen::Index>(k)) << 1, x, y, x * x, x * y, y * y;
        depth[static_cast<Eigen::Index>(k)] = (grid.p[skin[k]] - window.eye).norm();
    }
    const Eigen::VectorXd smooth = A * A.householderQr().solve(depth).eval();
    const double lift_mm = (smooth - depth).maxCoeff() + settings.drape_height_mm;  // nowhere in the skin
    for (std::size_t k = 0; k < under; ++k) {
        const std::size_t i = skin[k];
        const Vector2d at_mm = window.width_mm * grid.window[i];
        const double wave = std::sin(
            phase + 2 * std::numbers::pi * at_mm.dot(Vector2d(std::cos(fold_side), std::sin(fold_side))) / fold_mm);
        const double t = smooth[static_cast<Eigen::Index>(k)] - lift_mm + 0.15 * settings.drape_height_mm * wave;
        grid.p[i] = window.eye + t * grid.direction[i];
        draped[i] = 1;
    }
    return draped;
}

void spoil(Grid& grid, const TrialScanSettings& settings, TrialScan& scan, const std::vector<char>& draped,
           std::mt19937& random) {
    DepthSpoiler spoiler(settings.noise_mm, settings.stray_share, random);
    for (const auto i : grid.those_that_met()) {
        const DepthSpoiler::Spoilt spoilt = spoiler.next();
        grid.p[i] += spoilt.mm * grid.direction[i];
        ++(spoilt.stray ? scan.stray_points : draped[i] ? scan.drape_points : scan.bare_points);
    }
}

/// The head as it is: mirrored and grown about the middle of its box.
Vector3d as_is(const Vector3d& p_in_ct, const Vector3d& middle, const TrialScanSettings& settings) {
    Vector3d d = settings.scale * (p_in_ct - middle);
    if (settings.mirrored) d.x() = -d.x();
    return middle + d;
}

void set_targets(const Grid& grid, TrialScan& scan) {
    const auto skin = grid.those_that_met();
    Vector3d outwards = Vector3d::Zero();
    for (const auto i : skin) {
        scan.middle_in_ct += grid.p[i] / static_cast<double>(skin.size());
        outwards += grid.normal[i];
    }
    scan.targets_in_ct = targets_round(scan.middle_in_ct - 60 * outwards.normalized());
}

}  // namespace

TrialScan trial_scan(const TrialSurface& surface, const TrialScanSettings& settings) {
    TrialScan scan;
    const Window window(surface, settings);
    const Grid coarse = cast(surface, window, 40);
    const auto share = static_cast<double>(coarse.those_that_met().size()) / static_cast<double>(coarse.met.size());
    if (share < 0.02) return scan;
    const int columns = static_cast<int>(std::sqrt(settings.points / share * 4 / 3));
    Grid grid = cast(surface, window, columns);
    if (grid.those_that_met().size() < 200) return scan;
    set_targets(grid, scan);
    std::mt19937 random(settings.seed);
    move_skin(grid, settings);
    const auto draped = lay_drape(grid, window, settings, random);
    spoil(grid, settings, scan, draped, random);
    scan.rig_from_ct = random_pose(settings.seed);
    const Vector3d middle = surface.middle_in_ct();
    scan.viewpoint_in_rig = scan.rig_from_ct * as_is(window.eye, middle, settings);
    for (const auto i : grid.those_that_met()) {
        const Vector3d n = grid.normal_at(i);
        const Vector3d turned = as_is(middle + n, middle, settings) - middle;
        scan.cloud.points_in_rig.emplace_back(scan.rig_from_ct * as_is(grid.p[i], middle, settings));
        scan.cloud.normals_in_rig.emplace_back((scan.rig_from_ct.linear() * turned).normalized());
    }
    return scan;
}

PoseError pose_error(const RigidTransform& patient_from_ct, const TrialScan& scan) {
    PoseError error{angle_between(patient_from_ct, scan.rig_from_ct) * 180 / std::numbers::pi, 0, 0};
    error.middle_mm = (patient_from_ct * scan.middle_in_ct - scan.rig_from_ct * scan.middle_in_ct).norm();
    for (const Vector3d& p : scan.targets_in_ct)
        error.target_mm = std::max(error.target_mm, (patient_from_ct * p - scan.rig_from_ct * p).norm());
    return error;
}

}  // namespace planlight::test
