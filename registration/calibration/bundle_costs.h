#pragma once

#include <ceres/jet.h>
#include <ceres/rotation.h>

#include <Eigen/Dense>
#include <cmath>

#include "registration/calibration/board_spec.h"
#include "registration/calibration/observe_pose.h"

// Heavy: for bundle_adjustment.cpp only. The geometry and the residuals, for numbers and for Ceres' derivatives alike.
// Lens numbers: fx fy cx cy k1 k2 p1 p2 k3; places: rotation vector, then shift in mm.
namespace planlight {

/// A point of plain numbers or of Ceres' numbers with derivatives.
template <typename T>
struct V3 {
    T x, y, z;
};

/// The point by a place: turned by its rotation vector, then shifted.
template <typename T>
V3<T> moved(const T* twist, const V3<T>& p) {
    const T in[3] = {p.x, p.y, p.z};
    T out[3];
    ceres::AngleAxisRotatePoint(twist, in, out);
    return {out[0] + twist[3], out[1] + twist[4], out[2] + twist[5]};
}

/// A direction by the inverse of the place's rotation.
template <typename T>
V3<T> turned_back(const T* twist, const V3<T>& p) {
    const T back[3] = {-twist[0], -twist[1], -twist[2]}, in[3] = {p.x, p.y, p.z};
    T out[3];
    ceres::AngleAxisRotatePoint(back, in, out);
    return {out[0], out[1], out[2]};
}

/// Brown's lens model with k1, k2, k3, p1, p2 (OpenCV's order of terms), on normalised coordinates.
template <typename T>
void distort(const T* k, const T& x, const T& y, T* out) {
    const T r2 = x * x + y * y;
    const T radial = 1.0 + r2 * (k[4] + r2 * (k[5] + r2 * k[8]));
    out[0] = x * radial + 2.0 * k[6] * x * y + k[7] * (r2 + 2.0 * x * x);
    out[1] = y * radial + k[6] * (r2 + 2.0 * y * y) + 2.0 * k[7] * x * y;
}

/// A point in the device's frame, mm, to its pixel; z must not be 0.
template <typename T>
void pixel_of(const T* k, const V3<T>& p, T* pixel) {
    T d[2];
    distort(k, T(p.x / p.z), T(p.y / p.z), d);
    pixel[0] = k[0] * d[0] + k[2];
    pixel[1] = k[1] * d[1] + k[3];
}

/// The value without its derivatives.
inline double plain(double v) {
    return v;
}
template <typename J, int N>
double plain(const ceres::Jet<J, N>& v) {
    return v.a;
}

/// The normalised point that is seen at a pixel. Newton on plain numbers; one more step with derivatives gives those of
/// the inverse function exactly.
template <typename T>
void undistorted(const T* k, const Eigen::Vector2d& pixel, T* xy) {
    double n[9];
    for (int i = 0; i < 9; ++i) n[i] = plain(k[i]);
    double x = (pixel.x() - n[2]) / n[0], y = (pixel.y() - n[3]) / n[1];
    const double u = x, v = y;
    Eigen::Matrix2d inverse = Eigen::Matrix2d::Identity();
    for (int i = 0; i < 20; ++i) {
        double d[2], dx[2], dy[2];
        constexpr double kStep = 1e-6;
        distort(n, x, y, d);
        distort(n, x + kStep, y, dx);
        distort(n, x, y + kStep, dy);
        Eigen::Matrix2d J;
        J << (dx[0] - d[0]) / kStep, (dy[0] - d[0]) / kStep, (dx[1] - d[1]) / kStep, (dy[1] - d[1]) / kStep;
        inverse = J.inverse();
        const Eigen::Vector2d step = inverse * Eigen::Vector2d(u - d[0], v - d[1]);
        x += step.x();
        y += step.y();
        if (!(step.squaredNorm() > 1e-26)) break;
    }
    T d[2];
    distort(k, T(x), T(y), d);
    const T du = (pixel.x() - k[2]) / k[0] - d[0], dv = (pixel.y() - k[3]) / k[1] - d[1];
    xy[0] = x + inverse(0, 0) * du + inverse(0, 1) * dv;
    xy[1] = y + inverse(1, 0) * du + inverse(1, 1) * dv;
}

/// The board's corners on a plane or on the bent board.
struct BoardShape {
    double middle_x, middle_y, half;
    explicit BoardShape(const BoardSpec& board)
        : middle_x(board.width_mm() / 2),
          middle_y(board.height_mm() / 2),
          half(std::hypot(board.width_mm(), board.height_mm()) / 2) {}
    template <typename T>
    T z(const T* bend, const T& px, const T& py) const {
        const T x = (px - middle_x) / half, y = (py - middle_y) / half;
        return bend[0] * x * x + bend[1] * x * y + bend[2] * y * y;
    }
};

/// A corner in a camera: camera numbers, camera_from_rig, rig_from_board, bend.
struct CornerCost {
    Eigen::Vector2d seen;
    Eigen::Vector3d flat;
    BoardShape shape;
    double sigma;
    template <typename T>
    bool operator()(const T* camera, const T* camera_from_rig, const T* rig_from_board, const T* bend,
                    T* residual) const {
        const T x(flat.x()), y(flat.y());
        const V3<T> p = moved(camera_from_rig, moved(rig_from_board, V3<T>{x, y, shape.z(bend, x, y)}));
        T pixel[2];
        pixel_of(camera, p, pixel);
        residual[0] = (pixel[0] - seen.x()) / sigma;
        residual[1] = (pixel[1] - seen.y()) / sigma;
        return true;
    }
};

/// A lit pixel: from the camera to the board, from there into the projector.
struct LightCost {
    LightSample sample;
    BoardShape shape;
    double sigma;
    template <typename T>
    bool operator()(const T* camera, const T* camera_from_rig, const T* projector, const T* projector_from_rig,
                    const T* rig_from_board, const T* bend, T* residual) const {
        T xy[2];
        undistorted(camera, sample.pixel_in_camera, xy);
        const V3<T> minus{-camera_from_rig[3], -camera_from_rig[4], -camera_from_rig[5]};
        const V3<T> eye = turned_back(camera_from_rig, minus),
                    way = turned_back(camera_from_rig, V3<T>{xy[0], xy[1], T(1.0)});
        const V3<T> origin = turned_back(
            rig_from_board, V3<T>{eye.x - rig_from_board[3], eye.y - rig_from_board[4], eye.z - rig_from_board[5]});
        const V3<T> d = turned_back(rig_from_board, way);
        T s = -origin.z / d.z;
        for (int i = 0; i < 2; ++i) s = (shape.z(bend, T(origin.x + s * d.x), T(origin.y + s * d.y)) - origin.z) / d.z;
        const V3<T> on_board{origin.x + s * d.x, origin.y + s * d.y, origin.z + s * d.z};
        T pixel[2];
        pixel_of(projector, moved(projector_from_rig, moved(rig_from_board, on_board)), pixel);
        residual[0] = (pixel[0] - sample.pixel_in_projector.x()) / sigma;
        residual[1] = (pixel[1] - sample.pixel_in_projector.y()) / sigma;
        return true;
    }
};

/// What is known of any lens before: square pixels, and distortion terms of so many pixels in the picture's corner.
struct LensPrior {
    double aspect_sigma, corner, corner_px;  ///< normalised distance and pixels from the axis to the corner
    bool sixth_order;
    template <typename T>
    bool operator()(const T* k, T* residual) const {
        const double r2 = corner * corner;
        residual[0] = (k[0] / k[1] - 1.0) / aspect_sigma;
        residual[1] = k[4] * (r2 * corner_px / (0.25 * corner_px));
        residual[2] = k[5] * (r2 * r2 * corner_px / 10.0);
        residual[3] = k[6] * (corner * corner_px / 3.0);
        residual[4] = k[7] * (corner * corner_px / 3.0);
        residual[5] = sixth_order ? T(k[8] * (r2 * r2 * r2 * corner_px / 5.0)) : T(0.0);
        return true;
    }
};

/// Holds the board's bend near none, by `BundleSettings::bend_sigma_mm`.
struct BendPrior {
    double sigma_mm;
    template <typename T>
    bool operator()(const T* bend, T* residual) const {
        for (int i = 0; i < 3; ++i) residual[i] = bend[i] / sigma_mm;
        return true;
    }
};

}  // namespace planlight
