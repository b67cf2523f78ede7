#include "tests/registration/matching/trial_scan.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tests/registration/matching/matching_scenes.h"
#include "tests/registration/matching/moved_skin.h"

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

/// A grid of rays: what each met.
struct Grid {
    int columns = 0, rows = 0;
    std::vector<Vector2d> window;  ///< of each ray
    std::vector<Vector3d> direction;
    std::vector<char> met;
    std::vector<Vector3d> p, normal;  ///< in ct
};

Grid cast(const TrialSurface& surface, const Window& window, int columns) {
    Grid grid;
    grid.columns = columns;
    grid.rows = std::max(1, columns * 3 / 4);
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

std::vector<std::size_t> met(const Grid& grid) {
    std::vector<std::size_t> which;
    for (std::size_t i = 0; i < grid.met.size(); ++i)
        if (grid.met[i]) which.push_back(i);
    return which;
}

/// The skin's movement acts on the head, before it is seen.
void move_skin(Grid& grid, const TrialScanSettings& settings) {
    if (settings.movement.empty() || !(settings.movement_mm > 0)) return;
    const auto skin = met(grid);
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
    auto skin = met(grid);
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

/// The plane through the rays round one that met about the same surface; towards the devices.
Vector3d normal_of(const Grid& grid, std::size_t at, double spacing_mm) {
    constexpr int kReach = 3;
    const double farthest_mm = 2.5 * kReach * spacing_mm + 1;
    const int row = static_cast<int>(at) / grid.columns, column = static_cast<int>(at) % grid.columns;
    Vector3d sum = Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    int count = 0;
    for (int j = std::max(0, row - kReach); j <= std::min(grid.rows - 1, row + kReach); ++j)
        for (int i = std::max(0, column - kReach); i <= std::min(grid.columns - 1, column + kReach); ++i) {
            const auto k = static_cast<std::size_t>(j * grid.columns + i);
            if (!grid.met[k]) continue;
            const Vector3d d = grid.p[k] - grid.p[at];
            if (d.norm() > farthest_mm) continue;
            sum += d;
            squares += d * d.transpose();
            ++count;
        }
    if (count < 6) return -grid.direction[at];
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(squares / count - sum * sum.transpose() / (count * count));
    const Vector3d n = solver.eigenvectors().col(0);
    return n.dot(grid.direction[at]) > 0 ? Vector3d(-n) : n;
}

void spoil(Grid& grid, const TrialScanSettings& settings, TrialScan& scan, const std::vector<char>& draped,
           std::mt19937& random) {
    std::normal_distribution<double> noise(0, 1);
    std::uniform_real_distribution<double> unit;
    for (const auto i : met(grid)) {
        const double off = settings.noise_mm * noise(random), stray = unit(random), way = unit(random),
                     far = unit(random);
        const bool is_stray = stray < settings.stray_share;
        const double thrown = is_stray ? (way < 0.5 ? -1 : 1) * (15 + 85 * far) : 0;
        grid.p[i] += (off + thrown) * grid.direction[i];
        ++(is_stray ? scan.stray_points : draped[i] ? scan.drape_points : scan.bare_points);
    }
}

/// The head as it is: mirrored and grown about the middle of its box.
Vector3d as_is(const Vector3d& p_in_ct, const Vector3d& middle, const TrialScanSettings& settings) {
    Vector3d d = settings.scale * (p_in_ct - middle);
    if (settings.mirrored) d.x() = -d.x();
    return middle + d;
}

void set_targets(const Grid& grid, TrialScan& scan) {
    const auto skin = met(grid);
    Vector3d outwards = Vector3d::Zero();
    for (const auto i : skin) {
        scan.middle_in_ct += grid.p[i] / static_cast<double>(skin.size());
        outwards += grid.normal[i];
    }
    const Vector3d deep = scan.middle_in_ct - 60 * outwards.normalized();
    scan.targets_in_ct.push_back(deep);
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-40., 40.}) scan.targets_in_ct.emplace_back(deep + side * Vector3d::Unit(axis));
}

}  // namespace

TrialScan trial_scan(const TrialSurface& surface, const TrialScanSettings& settings) {
    TrialScan scan;
    const Window window(surface, settings);
    const Grid coarse = cast(surface, window, 40);
    const auto share = static_cast<double>(met(coarse).size()) / static_cast<double>(coarse.met.size());
    if (share < 0.02) return scan;
    const int columns = static_cast<int>(std::sqrt(settings.points / share * 4 / 3));
    Grid grid = cast(surface, window, columns);
    if (met(grid).size() < 200) return scan;
    set_targets(grid, scan);
    std::mt19937 random(settings.seed);
    move_skin(grid, settings);
    const auto draped = lay_drape(grid, window, settings, random);
    spoil(grid, settings, scan, draped, random);
    scan.rig_from_ct = random_pose(settings.seed);
    const Vector3d middle = surface.middle_in_ct();
    scan.viewpoint_in_rig = scan.rig_from_ct * as_is(window.eye, middle, settings);
    for (const auto i : met(grid)) {
        const Vector3d n = normal_of(grid, i, window.width_mm / columns);
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
