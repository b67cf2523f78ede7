// How flat the planes in a cloud are: measure_flatness CLOUD.ply [REACH_MM]. The three planes with most points within
// REACH_MM (3), and the rms distance of these points to the plane and to a surface of second degree.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

#include "planning_io/surface/mesh_file.h"
#include "planning_io/types/error.h"

using namespace planlight;

namespace {

/// rms of the heights over the least-squares surface of degree 1 or 2; the heights above it in `off`.
double fit(const std::vector<Eigen::Vector3d>& points, int terms, std::vector<double>& off) {
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(terms, terms);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(terms);
    const auto row = [&](const Eigen::Vector3d& p) {
        Eigen::VectorXd r(6);
        const double x = p.x() / 100, y = p.y() / 100;
        r << 1, x, y, x * x, x * y, y * y;
        return Eigen::VectorXd(r.head(terms));
    };
    for (const auto& p : points) {
        A += row(p) * row(p).transpose();
        b += row(p) * p.z();
    }
    const Eigen::VectorXd surface = A.ldlt().solve(b);
    double squares = 0;
    off.clear();
    for (const auto& p : points) {
        off.push_back(p.z() - row(p).dot(surface));
        squares += off.back() * off.back();
    }
    return std::sqrt(squares / static_cast<double>(points.size()));
}

/// Into the frame of the main axes: z across the plane.
std::vector<Eigen::Vector3d> in_plane(const std::vector<Eigen::Vector3d>& points) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const auto& p : points) middle += p / static_cast<double>(points.size());
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    for (const auto& p : points) squares += (p - middle) * (p - middle).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(squares);
    std::vector<Eigen::Vector3d> turned;
    for (const auto& p : points) turned.push_back(axes.eigenvectors().rowwise().reverse().transpose() * (p - middle));
    return turned;
}

/// The points within `reach_mm` of the plane that most points lie on, out of 400 planes through three random ones; they
/// leave `points`.
std::vector<Eigen::Vector3d> take_plane(std::vector<Eigen::Vector3d>& points, double reach_mm, std::mt19937& random) {
    std::uniform_int_distribution<std::size_t> any(0, points.size() - 1);
    std::size_t most = 0;
    Eigen::Hyperplane<double, 3> best;
    for (int trial = 0; trial < 400; ++trial) {
        const Eigen::Vector3d a = points[any(random)], b = points[any(random)], c = points[any(random)];
        if ((b - a).cross(c - a).norm() < 500) continue;  // mm^2
        const auto plane = Eigen::Hyperplane<double, 3>::Through(a, b, c);
        std::size_t near = 0;
        for (std::size_t i = 0; i < points.size(); i += 7) near += plane.absDistance(points[i]) < reach_mm;
        if (near > most) most = near, best = plane;
    }
    const auto off = std::stable_partition(points.begin(), points.end(),
                                           [&](const Eigen::Vector3d& p) { return best.absDistance(p) >= reach_mm; });
    std::vector<Eigen::Vector3d> taken(off, points.end());
    points.erase(off, points.end());
    return taken;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        fmt::print(stderr, "usage: measure_flatness CLOUD.ply [REACH_MM]\n");
        return static_cast<int>(ExitCode::usage);
    }
    try {
        const double reach_mm = argc > 2 ? std::stod(argv[2]) : 3;
        std::vector<Eigen::Vector3d> points = read_cloud(argv[1]).points_in_rig;
        std::mt19937 random(1);
        for (int k = 0; k < 3 && points.size() > 1000; ++k) {
            const std::vector<Eigen::Vector3d> plane = in_plane(take_plane(points, reach_mm, random));
            if (plane.size() < 1000) break;
            Eigen::AlignedBox3d box;
            for (const auto& p : plane) box.extend(p);
            std::vector<double> off;
            const double flat = fit(plane, 3, off), bent = fit(plane, 6, off);
            fmt::print("plane of {} points over {:.0f} x {:.0f} mm: {:.3f} mm rms off it, {:.3f} mm off a bent one\n",
                       plane.size(), box.sizes().x(), box.sizes().y(), flat, bent);
        }
        return 0;
    } catch (const Error& error) {
        fmt::print(stderr, "{} {}\n", error.what(), error.remedy);
        return static_cast<int>(error.exit_code);
    }
}
