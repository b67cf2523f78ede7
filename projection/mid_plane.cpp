#include "projection/mid_plane.h"
#include "planning_io/types/statistics.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kSamples = 500;
constexpr int kRounds = 200;           // a round head turns slowly
constexpr double kStill = 1e-4;        // change of the normal per round
constexpr double kMaxTilt_cos = 0.82;  // 35 degrees
constexpr double kMaxResidual_mm = 6;
constexpr double kFarPair_mm = 25;  // no counterpart on the other side: the cut end of the volume

std::vector<Vector3d> samples_of(const TriangleMesh& mesh) {
    std::vector<Vector3d> skin;
    for (std::size_t v = 0; v < mesh.vertices_in_ct.size(); ++v)
        if (mesh.flags.empty() || mesh.flags[v] == kSkin) skin.push_back(mesh.vertices_in_ct[v]);
    std::vector<Vector3d> some;
    const std::size_t step = std::max<std::size_t>(1, skin.size() / kSamples);
    for (std::size_t i = 0; i < skin.size(); i += step) some.push_back(skin[i]);
    return some;
}

Vector3d mirrored(const Vector3d& p, const MidPlane& plane) {
    return p - 2 * plane.left_mm(p) * plane.normal_in_ct;
}

/// The plane that mirrors the points `p` onto their partners `q` in the least squares: through the middle of all, its
/// normal the direction in which they are most opposed.
MidPlane plane_of_pairs(const std::vector<Vector3d>& p, const std::vector<Vector3d>& q, const Vector3d& old_normal) {
    Vector3d p_mean = Vector3d::Zero(), q_mean = Vector3d::Zero();
    for (std::size_t i = 0; i < p.size(); ++i) p_mean += p[i], q_mean += q[i];
    p_mean /= static_cast<double>(p.size());
    q_mean /= static_cast<double>(p.size());
    Eigen::Matrix3d together = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < p.size(); ++i) together += (p[i] - p_mean) * (q[i] - q_mean).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(together + together.transpose());
    Vector3d normal = axes.eigenvectors().col(0);
    if (normal.dot(old_normal) < 0) normal = -normal;
    return {(p_mean + q_mean) / 2, normal, 0};
}

}  // namespace

std::optional<MidPlane> find_mid_plane(const SkinSurface& skin) {
    const auto samples = samples_of(skin.mesh());
    if (samples.size() < 50) return std::nullopt;
    Vector3d low = samples.front(), high = low;
    for (const auto& p : samples) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    MidPlane plane{(low + high) / 2, Vector3d::UnitX(), 0};
    for (int round = 0; round <= kRounds; ++round) {
        std::vector<Vector3d> p, q;
        std::vector<double> far;
        for (const Vector3d& sample : samples) {
            const Vector3d there = mirrored(sample, plane), nearest = skin.nearest(there).p_in_ct;
            const double distance = (nearest - there).norm();
            if (distance > kFarPair_mm) continue;
            far.push_back(distance);
            p.push_back(sample);
            q.push_back(nearest);
        }
        if (p.size() < samples.size() / 2) return std::nullopt;
        plane.residual_mm = median(far);
        const MidPlane next = plane_of_pairs(p, q, plane.normal_in_ct);
        const double change =
            (next.normal_in_ct - plane.normal_in_ct).norm() + std::abs(next.left_mm(plane.point_in_ct)) / 100;
        if (round == kRounds || change < kStill) break;
        plane = next;
    }
    if (plane.normal_in_ct.x() < kMaxTilt_cos || plane.residual_mm > kMaxResidual_mm) return std::nullopt;
    return plane;
}

}  // namespace planlight
