#include "registration/matching/match_evidence.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "planning_io/types/triangle_mesh.h"
#include "registration/matching/distance_field.h"
#include "registration/matching/gauss_newton.h"

namespace planlight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr double kLever_mm = 80;  // a turn is told as the movement it makes this far away

double median(std::vector<double>& values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// A scan point on the skin, as the linearised ICP sees it.
struct Contact {
    Vector3d x_in_ct, normal;
    double distance_mm;
    Vector6d J;
};

/// About `count` of the cloud's points that lie within 3 mm of real skin.
std::vector<Contact> contacts(const PointCloud& cloud, const SkinLut& lut, const IcpResult& icp, std::size_t count) {
    const DistanceField field(lut);
    std::vector<Contact> all;
    const std::size_t stride = std::max<std::size_t>(1, cloud.size() / std::max<std::size_t>(count, 1));
    for (std::size_t i = 0; i < cloud.size(); i += stride) {
        if (!cloud.points_in_rig[i].allFinite()) continue;
        Contact c;
        c.x_in_ct = icp.ct_from_rig * cloud.points_in_rig[i];
        const SkinPoint* s = lut.nearest_skin(c.x_in_ct);
        if (!s || s->flags != kSkin || !field.sample(c.x_in_ct, c.distance_mm, c.normal) || std::abs(c.distance_mm) > 3) continue;
        c.normal.normalize();
        c.J << (c.x_in_ct - icp.centre_in_ct).cross(c.normal), c.normal;
        all.push_back(c);
    }
    return all;
}

std::string in_words(const Vector6d& scaled) {
    static const char* const kAxes[] = {"left-right", "front-back", "head-foot"};
    const bool turns = scaled.head<3>().norm() > scaled.tail<3>().norm();
    int axis = 0;
    (turns ? scaled.head<3>() : scaled.tail<3>()).cwiseAbs().maxCoeff(&axis);
    return (turns ? std::string("turn about the ") : std::string("slide along the ")) + kAxes[axis] + " axis";
}

}  // namespace

CloudOnSkin lay_on_skin(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig, double inlier_distance_mm,
                        double skin_offset_mm) {
    const DistanceField field(lut);
    const bool has_normals = cloud.normals_in_rig.size() == cloud.size();
    CloudOnSkin result;
    std::vector<double> distances;
    double sum = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        if (!cloud.points_in_rig[i].allFinite()) continue;
        ++result.points;
        const Vector3d x = ct_from_rig * cloud.points_in_rig[i];
        const SkinPoint* s = lut.nearest_skin(x);
        if (s && s->flags != kSkin) continue;
        ++result.known;
        double d = std::numeric_limits<double>::infinity();
        Vector3d normal = Vector3d::Zero();
        if (s && field.sample(x, d, normal)) d -= skin_offset_mm;
        distances.push_back(std::abs(d));
        if (std::abs(d) > inlier_distance_mm) continue;
        if (has_normals && normal.dot(ct_from_rig.linear() * cloud.normals_in_rig[i]) < 0) continue;
        ++result.inliers;
        sum += d * d;
    }
    if (result.inliers > 0) result.inlier_rms_mm = std::sqrt(sum / static_cast<double>(result.inliers));
    result.median_mm = median(distances);
    return result;
}

WeakestWay weakest_way(const PoseCovariance& covariance) {
    WeakestWay way;
    way.sigma_mm = std::numeric_limits<double>::infinity();
    way.in_words = "move freely";
    if (!covariance.known() || !covariance.of_turn_and_shift.allFinite()) return way;
    const Vector6d scale = (Vector6d() << Vector3d::Constant(kLever_mm), Vector3d::Ones()).finished();
    const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(scale.asDiagonal() * covariance.of_turn_and_shift * scale.asDiagonal());
    way.sigma_mm = std::sqrt(std::max(solver.eigenvalues()(5), 0.0));
    way.in_words = in_words(solver.eigenvectors().col(5));
    return way;
}

double best_scale(const PointCloud& cloud, const SkinLut& lut, const IcpResult& icp) {
    using Vector7d = Eigen::Matrix<double, 7, 1>;
    using Matrix7d = Eigen::Matrix<double, 7, 7>;
    const std::vector<Contact> on_skin = contacts(cloud, lut, icp, 4000);
    if (on_skin.size() < 50) return 1;
    const DistanceField field(lut);
    Matrix3d A = Matrix3d::Identity();  // ct from ct: turned and scaled about the centre
    Vector3d moved = Vector3d::Zero();
    double scale = 1;
    for (int step = 0; step < 6; ++step) {
        Matrix7d H = Matrix7d::Zero();
        Vector7d g = Vector7d::Zero();
        for (const Contact& c : on_skin) {
            const Vector3d r = scale * A * (c.x_in_ct - icp.centre_in_ct);
            double d;
            Vector3d n;
            if (!field.sample(icp.centre_in_ct + moved + r, d, n)) continue;
            n.normalize();
            Vector7d J;
            J << r.cross(n) / kLever_mm, n, r.dot(n) / kLever_mm;
            const double w = tukey_weight(d, 1);
            H += w * J * J.transpose();
            g += w * d * J;
        }
        H.diagonal().array() += 1e-6 * H.trace();
        const Vector7d delta = -H.ldlt().solve(g);
        if (!delta.allFinite()) return 1;
        const Vector3d turn = delta.head<3>() / kLever_mm;
        if (turn.norm() > 0) A = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * A;
        moved += delta.segment<3>(3);
        scale *= std::clamp(1 + delta(6) / kLever_mm, 0.9, 1.1);
    }
    return scale;
}

Vector3d extents_mm(const PointCloud& cloud) {
    Vector3d middle = Vector3d::Zero();
    std::vector<double> values;
    for (int axis = 0; axis < 3; ++axis) {
        values.clear();
        for (const Vector3d& p : cloud.points_in_rig)
            if (p.allFinite()) values.push_back(p[axis]);
        middle[axis] = median(values);
    }
    values.clear();
    for (const Vector3d& p : cloud.points_in_rig)
        if (p.allFinite()) values.push_back((p - middle).norm());
    const double reach_mm = 3 * median(values);
    Vector3d sum = Vector3d::Zero();
    Matrix3d squares = Matrix3d::Zero();
    double count = 0;
    for (const Vector3d& p : cloud.points_in_rig) {
        if (!p.allFinite() || (p - middle).norm() > reach_mm) continue;
        sum += p - middle;
        squares += (p - middle) * (p - middle).transpose();
        ++count;
    }
    if (count < 3) return Vector3d::Zero();
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(squares / count - sum * sum.transpose() / (count * count));
    return (12 * solver.eigenvalues().cwiseMax(0)).cwiseSqrt().reverse();
}

PointCloud mirrored(const PointCloud& cloud) {
    PointCloud image = cloud;
    for (auto& p : image.points_in_rig) p.x() = -p.x();
    for (auto& n : image.normals_in_rig) n.x() = -n.x();
    return image;
}

}  // namespace planlight
