#include "registration/matching/match_evidence.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "planning_io/types/statistics.h"
#include "planning_io/types/triangle_mesh.h"
#include "registration/matching/distance_field.h"

namespace planlight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr double kLever_mm = 80;  // a turn is told as the movement it makes this far away

std::string in_words(const Vector6d& scaled) {
    static const char* const kAxes[] = {"left-right", "front-back", "head-foot"};
    const bool turns = scaled.head<3>().norm() > scaled.tail<3>().norm();
    int axis = 0;
    (turns ? scaled.head<3>() : scaled.tail<3>()).cwiseAbs().maxCoeff(&axis);
    return (turns ? std::string("turn about the ") : std::string("slide along the ")) + kAxes[axis] + " axis";
}

/// What stands out so that this movement would be seen.
std::string advice_against(const Vector6d& scaled) {
    static const char* const kAgainstTurns[] = {"forehead and chin, or an ear", "both ears, or forehead and chin",
                                                "the bridge of the nose or an ear"};
    static const char* const kAgainstSlides[] = {"a side of the head", "the face, or the back of the head",
                                                 "the chin, the brows or the crown"};
    const bool turns = scaled.head<3>().norm() > scaled.tail<3>().norm();
    int axis = 0;
    (turns ? scaled.head<3>() : scaled.tail<3>()).cwiseAbs().maxCoeff(&axis);
    return turns ? kAgainstTurns[axis] : kAgainstSlides[axis];
}

/// Mean square of the inliers' distances without the variance within cells.
class ShapeResidual {
public:
    void add(const Vector3d& x_in_ct, double distance_mm) {
        const Eigen::Vector3i at = (x_in_ct / kCell_mm).array().floor().cast<int>();
        Cell& cell = cells_[{at.x(), at.y(), at.z()}];
        ++cell.count;
        cell.sum += distance_mm;
        cell.squares += distance_mm * distance_mm;
    }
    double rms_mm() const {
        double all = 0, of_shape = 0;
        for (const auto& [at, cell] : cells_) {
            if (cell.count < 2) continue;
            const double mean = cell.sum / cell.count;
            const double variance = (cell.squares - cell.count * mean * mean) / (cell.count - 1);
            of_shape += cell.squares - cell.count * variance;
            all += cell.count;
        }
        return all == 0 ? 0 : std::sqrt(std::max(of_shape / all, 0.));
    }

private:
    static constexpr double kCell_mm = 6;
    struct Cell {
        double count = 0, sum = 0, squares = 0;
    };
    std::map<std::array<int, 3>, Cell> cells_;
};

}  // namespace

CloudOnSkin lay_on_skin(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                        double inlier_distance_mm, double skin_offset_mm) {
    const DistanceField field(lut);
    const bool has_normals = cloud.normals_in_rig.size() == cloud.size();
    CloudOnSkin result;
    std::vector<double> distances;
    ShapeResidual shape;
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
        if (d < -inlier_distance_mm) ++result.inside;
        if (std::abs(d) > inlier_distance_mm) continue;
        if (has_normals && normal.dot(ct_from_rig.linear() * cloud.normals_in_rig[i]) < 0) continue;
        ++result.inliers;
        sum += d * d;
        shape.add(x, d);
    }
    result.shape_rms_mm = shape.rms_mm();
    if (result.inliers > 0) result.inlier_rms_mm = std::sqrt(sum / static_cast<double>(result.inliers));
    result.median_mm = median(distances);
    return result;
}

WeakestWay weakest_way(const PoseCovariance& covariance) {
    WeakestWay way;
    way.sigma_mm = std::numeric_limits<double>::infinity();
    way.in_words = "move freely";
    way.advice = "more of the head";
    if (!covariance.known() || !covariance.of_turn_and_shift.allFinite()) return way;
    const Vector6d scale = (Vector6d() << Vector3d::Constant(kLever_mm), Vector3d::Ones()).finished();
    const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(scale.asDiagonal() * covariance.of_turn_and_shift *
                                                         scale.asDiagonal());
    way.sigma_mm = std::sqrt(std::max(solver.eigenvalues()(5), 0.0));
    way.in_words = in_words(solver.eigenvectors().col(5));
    way.advice = advice_against(solver.eigenvectors().col(5));
    return way;
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
