#include "registration/projector_measurement/fit_response.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Of gamma, dark end and bright end (shares of the scale).
double light_of(const Vector3d& p, double share) {
    return std::pow(std::clamp((share - p[1]) / (p[2] - p[1]), 0.0, 1.0), p[0]);
}

Vector3d bounded(Vector3d p) {
    return {std::clamp(p[0], 0.2, 6.0), std::clamp(p[1], 0.0, 0.45), std::clamp(p[2], 0.55, 1.0)};
}

/// Below it the curve's own shape (it is no exact power) is more than the noise.
constexpr double kShape = 0.001;

double weight(const ResponsePoint& point) {
    return 1 / (point.sigma * point.sigma + kShape * kShape);
}

double cost(const std::vector<ResponsePoint>& curve, const Vector3d& p) {
    double sum = 0;
    for (const ResponsePoint& point : curve) {
        const double off = point.light - light_of(p, point.grey / 255.0);
        sum += weight(point) * off * off;
    }
    return sum;
}

Matrix3d normal_matrix(const std::vector<ResponsePoint>& curve, const Vector3d& p, Vector3d& slope) {
    Matrix3d normal = Matrix3d::Zero();
    slope.setZero();
    for (const ResponsePoint& point : curve) {
        constexpr double kStep = 1e-5;
        Vector3d by_p;
        for (int k = 0; k < 3; ++k) {
            Vector3d up = p, down = p;
            up[k] += kStep, down[k] -= kStep;
            by_p[k] = (light_of(up, point.grey / 255.0) - light_of(down, point.grey / 255.0)) / (2 * kStep);
        }
        normal += weight(point) * by_p * by_p.transpose();
        slope += weight(point) * by_p * (point.light - light_of(p, point.grey / 255.0));
    }
    return normal;
}

/// Levenberg-Marquardt within the bounds.
Vector3d descend(const std::vector<ResponsePoint>& curve, Vector3d p) {
    double damping = 1e-3, least = cost(curve, p);
    for (int i = 0; i < 200 && damping < 1e12; ++i) {
        Vector3d slope;
        Matrix3d normal = normal_matrix(curve, p, slope);
        normal.diagonal() += damping * (normal.diagonal() + Vector3d::Constant(1e-6));
        const Vector3d tried = bounded(p + normal.ldlt().solve(slope));
        if (const double c = cost(curve, tried); c < least) {
            least = c, p = tried, damping /= 3;
        } else {
            damping *= 4;
        }
    }
    return p;
}

}  // namespace

void fit_response(ResponseResult& result) {
    Vector3d best(2.2, 0, 1);
    double least = 1e300;
    for (const double gamma : {1.0, 2.2})
        for (const double dark : {0.0, 0.06})
            for (const double bright : {0.92, 1.0}) {
                const Vector3d p = descend(result.curve, {gamma, dark, bright});
                if (const double c = cost(result.curve, p); c < least) least = c, best = p;
            }
    Vector3d slope;
    Matrix3d normal = normal_matrix(result.curve, best, slope);
    normal.diagonal() += Vector3d::Constant(1e-9);
    const double freedom = std::max(1.0, static_cast<double>(result.curve.size()) - 5);
    // How far the points truly lie from the curve, but not under their own noise.
    double noise = 0;
    for (const ResponsePoint& point : result.curve)
        noise += weight(point) * point.sigma * point.sigma / static_cast<double>(result.curve.size());
    const Matrix3d covariance = normal.inverse() * std::max(noise, least / freedom);
    result.gamma = best[0];
    result.gamma_sigma = std::sqrt(covariance(0, 0));
    result.dark_end = 255 * best[1];
    result.dark_end_sigma = 255 * std::sqrt(covariance(1, 1));
    result.bright_end = 255 * best[2];
    result.bright_end_sigma = 255 * std::sqrt(covariance(2, 2));
    constexpr double kNoticed_grey = 2;
    result.crushes_darks = result.dark_end > std::max(kNoticed_grey, 3 * result.dark_end_sigma);
    result.crushes_whites = 255 - result.bright_end > std::max(kNoticed_grey, 3 * result.bright_end_sigma);
    for (const ResponsePoint& point : result.curve)
        result.worst_departure =
            std::max(result.worst_departure, std::abs(point.light - fitted_light(result, point.grey)));
}

double fitted_light(const ResponseResult& result, double grey) {
    return light_of({result.gamma, result.dark_end / 255, result.bright_end / 255}, grey / 255);
}

}  // namespace planlight
