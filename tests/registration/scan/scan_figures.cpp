#include "tests/registration/scan/scan_figures.h"

#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <unordered_map>

#include "planning_io/types/statistics.h"
#include "registration/scan/triangulate/point_covariance.h"

namespace planlight::scan_rooms {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using simulation::SimulatedRig;

/// Points by cube; the key keeps 21 bits an axis.
class Cubes {
public:
    Cubes(const std::vector<Vector3d>& points, double edge_mm) : points_(points), edge_(edge_mm) {
        for (std::size_t i = 0; i < points.size(); ++i) cubes_[key(cell(points[i]))].push_back(i);
    }
    const std::unordered_map<std::uint64_t, std::vector<std::size_t>>& all() const { return cubes_; }
    /// A point within one edge of `p`.
    bool any_near(const Vector3d& p) const {
        const Eigen::Vector3i c = cell(p);
        for (int k = 0; k < 27; ++k) {
            const auto found = cubes_.find(key(c + Eigen::Vector3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)));
            if (found == cubes_.end()) continue;
            for (const std::size_t i : found->second)
                if ((points_[i] - p).squaredNorm() <= edge_ * edge_) return true;
        }
        return false;
    }

private:
    Eigen::Vector3i cell(const Vector3d& p) const { return (p / edge_).array().floor().cast<int>(); }
    static std::uint64_t key(const Eigen::Vector3i& c) {
        const auto part = [](int v) { return static_cast<std::uint64_t>(v + (1 << 20)) & 0x1fffff; };
        return part(c.x()) | part(c.y()) << 21 | part(c.z()) << 42;
    }
    const std::vector<Vector3d>& points_;
    double edge_;
    std::unordered_map<std::uint64_t, std::vector<std::size_t>> cubes_;
};

/// The distances to the skin as their mean in small cubes and what scatters about it.
void split_error(const std::vector<Vector3d>& points, const std::vector<double>& errors,
                 const std::vector<bool>& facing, CloudFigures& figures) {
    constexpr double kCube_mm = 4;
    constexpr std::size_t kLeast = 6;
    double squares = 0, squares_facing = 0, all = 0, all_facing = 0, slow = 0, cubes = 0, sum = 0;
    std::vector<double> sizes;
    const Cubes in_cubes(points, kCube_mm);
    for (const auto& [key, members] : in_cubes.all()) {
        if (members.size() < kLeast) continue;
        double mean = 0;
        for (const std::size_t i : members) mean += errors[i] / static_cast<double>(members.size());
        const double widened = static_cast<double>(members.size()) / static_cast<double>(members.size() - 1);
        for (const std::size_t i : members) {
            const double square = widened * (errors[i] - mean) * (errors[i] - mean);
            squares += square;
            ++all;
            sizes.push_back(std::sqrt(square));
            if (!facing[i]) continue;
            squares_facing += square;
            ++all_facing;
        }
        slow += mean * mean;
        ++cubes;
    }
    for (const double e : errors) sum += e;
    figures.bias_mm = sum / std::max<double>(1, static_cast<double>(errors.size()));
    figures.noise_mm = std::sqrt(squares_facing / std::max(1.0, all_facing));
    figures.noise_all_mm = std::sqrt(squares / std::max(1.0, all));
    figures.noise_usual_mm = 1.4826 * median(sizes);
    figures.slow_mm = std::sqrt(slow / std::max(1.0, cubes));
}

/// Distance to the skin against the sigma that the point's covariance gives it along the normal.
void judge_covariance(const PointCloud& cloud, const std::vector<double>& errors, const RigCalibration& rig,
                      CloudFigures& figures) {
    std::vector<double> squares;
    double sum = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const Eigen::Matrix3d covariance = point_covariance(cloud.points_in_rig[i], rig, cloud.sigma_mm[i]);
        const Vector3d& n = cloud.normals_in_rig[i];
        squares.push_back(errors[i] * errors[i] / n.dot(covariance * n));
        sum += squares.back();
    }
    figures.chi_square = sum / std::max<double>(1, static_cast<double>(squares.size()));
    figures.chi_square_median = median(squares) / 0.455;
}

/// Less than 65 degrees between the normal and the way to a device.
bool faces(const CameraModel& device, const Vector3d& p_in_rig, const Vector3d& normal_in_rig) {
    static const double least_cosine = std::cos(65 * M_PI / 180);
    return normal_in_rig.dot((device.centre_in_rig() - p_in_rig).normalized()) > least_cosine;
}

bool on_sticker(const SimulatedRig& room, const Vector3d& p_in_ct) {
    constexpr double kSticker_mm = 9;
    const auto& markers = room.true_markers_in_ct();
    return std::any_of(markers.begin(), markers.end(),
                       [&](const Vector3d& m) { return (m - p_in_ct).norm() < kSticker_mm; });
}

/// Something else than smooth skin within 3 pixels: the light there comes from several places at once.
bool by_an_edge(const SimulatedRig& room, SimulatedRig::Camera camera, const Vector2d& pixel, Instant at) {
    constexpr double kJump_px = 15;  // projector pixels over 3 camera pixels
    const auto here = room.true_sight(camera, pixel, at);
    if (!here || !here->lit_by) return true;
    for (int dy = -3; dy <= 3; ++dy)
        for (int dx = -3; dx <= 3; ++dx) {
            const auto near = room.true_sight(camera, pixel + Vector2d(dx, dy), at);
            if (!near || !near->lit_by || (*near->lit_by - *here->lit_by).cwiseAbs().maxCoeff() > kJump_px) return true;
        }
    return false;
}

}  // namespace

CloudFigures cloud_figures(const ScanResult& scan, const SimulatedRig& room, const RigCalibration& rig, Instant at) {
    const PointCloud& cloud = scan.clean.kept;
    CloudFigures figures;
    figures.points = cloud.size();
    const std::vector<double> errors = room.scan_errors_mm(cloud.points_in_rig, at);
    split_error(cloud.points_in_rig, errors, facing_points(cloud, room, rig, at), figures);
    judge_covariance(cloud, errors, rig, figures);
    figures.completeness = completeness(cloud.points_in_rig, room, room.true_rig(), at);
    return figures;
}

std::vector<bool> facing_points(const PointCloud& cloud, const SimulatedRig& room, const RigCalibration& rig,
                                Instant at) {
    const RigidTransform ct_from_rig = room.true_rig_from_ct(at).inverse();
    std::vector<bool> facing;
    for (std::size_t i = 0; i < cloud.size(); ++i)
        facing.push_back(faces(rig.projector, cloud.points_in_rig[i], cloud.normals_in_rig[i]) &&
                         !on_sticker(room, ct_from_rig * cloud.points_in_rig[i]));
    return facing;
}

double scatter_in_cubes_mm(const std::vector<Vector3d>& points, const std::vector<double>& errors) {
    CloudFigures figures;
    split_error(points, errors, std::vector<bool>(points.size(), true), figures);
    return figures.noise_mm;
}

double completeness(const std::vector<Vector3d>& points_in_rig, const SimulatedRig& room,
                    const RigCalibration& true_rig, Instant at) {
    constexpr double kReach_mm = 2;
    const Cubes cubes(points_in_rig, kReach_mm);
    const RigidTransform rig_from_ct = room.true_rig_from_ct(at);
    const int step = std::max(2, true_rig.projector.width / 240);
    const int columns = true_rig.projector.width / step, rows = true_rig.projector.height / step;
    std::atomic<std::size_t> there{0}, found{0};
    tbb::parallel_for(0, rows, [&](int r) {
        for (int c = 0; c < columns; ++c) {
            const auto light = room.true_light(Vector2d(c + 0.5, r + 0.5) * step, at);
            if (!light || on_sticker(room, light->p_in_ct)) continue;
            const Vector3d p = rig_from_ct * light->p_in_ct, n = rig_from_ct.linear() * light->normal_in_ct;
            if (!faces(true_rig.projector, p, n)) continue;
            if (!(faces(true_rig.left_camera, p, n) && room.truly_seen(SimulatedRig::Camera::left, *light, at)) &&
                !(faces(true_rig.right_camera, p, n) && room.truly_seen(SimulatedRig::Camera::right, *light, at)))
                continue;
            ++there;
            if (cubes.any_near(p)) ++found;
        }
    });
    return there == 0 ? 0 : static_cast<double>(found) / static_cast<double>(there);
}

CodeFigures code_figures(const DecodedView& view, const SimulatedRig& room, SimulatedRig::Camera camera,
                         const RigCalibration& true_rig, Instant at) {
    constexpr double kWrong_px = 2;
    const RigidTransform rig_from_ct = room.true_rig_from_ct(at);
    const CameraModel& eye = camera == SimulatedRig::Camera::left ? true_rig.left_camera : true_rig.right_camera;
    std::atomic<std::size_t> looked_at{0}, wrong{0}, inside{0}, facing{0};
    tbb::parallel_for(0, view.height / 2, [&](int half) {
        const int y = 2 * half;
        for (int x = 0; x < view.width; x += 2) {
            const std::size_t i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(x);
            if (std::isnan(view.column[i])) continue;
            ++looked_at;
            const auto sight = room.true_sight(camera, Vector2d(x, y), at);
            // Columns only: the row is taken as it is, or from the middle where there is none.
            const double true_row = sight && sight->lit_by ? sight->lit_by->y() : true_rig.projector.height / 2.0;
            const double row = view.row.empty() ? true_row : view.row[i];
            const Vector2d code(view.column[i], row);
            if (sight && sight->lit_by && (code - *sight->lit_by).cwiseAbs().maxCoeff() <= kWrong_px) continue;
            ++wrong;
            const Vector2d last(true_rig.projector.width - 4, true_rig.projector.height - 4);
            const bool at_rim = code.minCoeff() < 3 || (last - code).minCoeff() < 0;
            if (at_rim || by_an_edge(room, camera, Vector2d(x, y), at)) continue;
            ++inside;
            const Vector3d p = rig_from_ct * sight->p_in_ct, n = rig_from_ct.linear() * sight->normal_in_ct;
            if (faces(eye, p, n) && faces(true_rig.projector, p, n)) ++facing;
        }
    });
    return {looked_at, wrong, inside, facing};
}

double fitted_radius_mm(const std::vector<Vector3d>& points) {
    if (points.size() < 10) return 0;
    Vector3d middle = Vector3d::Zero();
    for (const Vector3d& p : points) middle += p / static_cast<double>(points.size());
    // Algebraic start: |p|^2 = 2 c.p + (r^2 - |c|^2), about the middle.
    Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
    Eigen::Vector4d b = Eigen::Vector4d::Zero();
    for (const Vector3d& p : points) {
        const Eigen::Vector4d row = (p - middle).homogeneous();
        A += row * row.transpose();
        b += row * (p - middle).squaredNorm();
    }
    const Eigen::Vector4d start = A.ldlt().solve(b);
    Vector3d centre = middle + start.head<3>() / 2;
    double radius = std::sqrt(start(3) + start.head<3>().squaredNorm() / 4);
    constexpr double kHuber_mm = 0.2;
    for (int iteration = 0; iteration < 20; ++iteration) {
        A.setZero();
        b.setZero();
        for (const Vector3d& p : points) {
            const double distance = (p - centre).norm(), r = distance - radius;
            const double weight = std::min(1.0, kHuber_mm / std::max(std::abs(r), 1e-12));
            Eigen::Vector4d J;
            J << (p - centre) / distance, 1;
            A += weight * J * J.transpose();
            b += weight * J * r;
        }
        const Eigen::Vector4d step = A.ldlt().solve(b);
        centre += step.head<3>();
        radius += step(3);
        if (step.norm() < 1e-9) break;
    }
    return radius;
}

}  // namespace planlight::scan_rooms
