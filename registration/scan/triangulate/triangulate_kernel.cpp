#include "registration/scan/triangulate/triangulate_kernel.h"

#include <cmath>

#include "planning_io/types/processor_clones.h"

// Written without branches and with plain numbers, or the compiler could not put points side by side.
namespace planlight::triangulate_kernel {
namespace {

struct Triple {
    double x, y, z;
};
/// Symmetric: xx xy xz yy yz zz.
struct Symmetric {
    double xx, xy, xz, yy, yz, zz;
};

PLANLIGHT_INLINE double dot(const Triple& a, const Triple& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// The distorted normalised point, and its (symmetric) derivative.
struct Distorted {
    double x, y, xx, xy, yy;
};
PLANLIGHT_INLINE Distorted distort(const Device& d, double x, double y) {
    const double r2 = x * x + y * y;
    const double radial = 1 + r2 * (d.k1 + r2 * (d.k2 + r2 * d.k3)), slope = d.k1 + r2 * (2 * d.k2 + 3 * r2 * d.k3);
    return {x * radial + 2 * d.p1 * x * y + d.p2 * (r2 + 2 * x * x),
            y * radial + d.p1 * (r2 + 2 * y * y) + 2 * d.p2 * x * y,
            radial + 2 * x * x * slope + 2 * d.p1 * y + 6 * d.p2 * x, 2 * x * y * slope + 2 * d.p1 * x + 2 * d.p2 * y,
            radial + 2 * y * y * slope + 6 * d.p1 * y + 2 * d.p2 * x};
}

/// Enough for a start, which the steps of least squares then adjust by the lens itself: of a lens with k1 = -0.3, whose
/// picture folds back at 46.6 degrees, up to 45.3.
constexpr int kNewtonSteps = 5;
constexpr double kOff = 1e-6;  // 2 thousandths of a pixel at 2000 px of focal length

/// Direction of the ray through a pixel, unit length, in rig; clears `good` where Newton's method does not get there.
PLANLIGHT_INLINE Triple direction_of(const Device& d, double pixel_x, double pixel_y, double& good) {
    const double wanted_x = (pixel_x - d.cx) / d.fx, wanted_y = (pixel_y - d.cy) / d.fy;
    double x = wanted_x, y = wanted_y;
#pragma GCC unroll 5
    for (int k = 0; k < kNewtonSteps; ++k) {
        const Distorted at = distort(d, x, y);
        const double ex = at.x - wanted_x, ey = at.y - wanted_y, by_determinant = 1 / (at.xx * at.yy - at.xy * at.xy);
        x -= (at.yy * ex - at.xy * ey) * by_determinant;
        y -= (at.xx * ey - at.xy * ex) * by_determinant;
    }
    const Distorted at = distort(d, x, y);
    const double off = (at.x - wanted_x) * (at.x - wanted_x) + (at.y - wanted_y) * (at.y - wanted_y);
    good = (off < kOff * kOff) & (at.xx * at.yy > at.xy * at.xy) ? good : 0;
    const double by_length = 1 / std::sqrt(x * x + y * y + 1);
    return {(d.r[0] * x + d.r[3] * y + d.r[6]) * by_length, (d.r[1] * x + d.r[4] * y + d.r[7]) * by_length,
            (d.r[2] * x + d.r[5] * y + d.r[8]) * by_length};
}

/// The pixel at which a rig point is seen and its derivative by the point.
struct Seen {
    double u, v;
    Triple du, dv;
};
PLANLIGHT_INLINE Seen see(const Device& d, const Triple& p, double& good) {
    const double qx = d.r[0] * p.x + d.r[1] * p.y + d.r[2] * p.z + d.t[0];
    const double qy = d.r[3] * p.x + d.r[4] * p.y + d.r[5] * p.z + d.t[1];
    const double qz = d.r[6] * p.x + d.r[7] * p.y + d.r[8] * p.z + d.t[2];
    const double by_z = 1 / qz, x = qx * by_z, y = qy * by_z;
    const Distorted at = distort(d, x, y);
    good = (qz > 1e-6) & (at.xx > 0) & (at.xx * at.yy > at.xy * at.xy) ? good : 0;
    const double ux = d.fx * at.xx * by_z, uy = d.fx * at.xy * by_z, uz = -(ux * x + uy * y);
    const double vx = d.fy * at.xy * by_z, vy = d.fy * at.yy * by_z, vz = -(vx * x + vy * y);
    return {d.fx * at.x + d.cx,
            d.fy * at.y + d.cy,
            {ux * d.r[0] + uy * d.r[3] + uz * d.r[6], ux * d.r[1] + uy * d.r[4] + uz * d.r[7],
             ux * d.r[2] + uy * d.r[5] + uz * d.r[8]},
            {vx * d.r[0] + vy * d.r[3] + vz * d.r[6], vx * d.r[1] + vy * d.r[4] + vz * d.r[7],
             vx * d.r[2] + vy * d.r[5] + vz * d.r[8]}};
}

/// The middle of the shortest way between two rays; `along` is how far the first one goes to it.
PLANLIGHT_INLINE Triple between(const Device& a, const Device& b, const Triple& u, const Triple& v, double& along,
                                double& good) {
    const Triple w{b.eye[0] - a.eye[0], b.eye[1] - a.eye[1], b.eye[2] - a.eye[2]};
    const double cosine = dot(u, v), sine_squared = 1 - cosine * cosine, wu = dot(w, u), wv = dot(w, v);
    const double by_sine = 1 / (sine_squared > 1e-9 ? sine_squared : 1e-9);
    const double s = (wu - cosine * wv) * by_sine, t = (cosine * wu - wv) * by_sine;
    good = (sine_squared >= 1e-6) & (s > 0) & (t > 0) ? good : 0;
    along = s;
    return {0.5 * (a.eye[0] + s * u.x + b.eye[0] + t * v.x), 0.5 * (a.eye[1] + s * u.y + b.eye[1] + t * v.y),
            0.5 * (a.eye[2] + s * u.z + b.eye[2] + t * v.z)};
}

/// Normal equations of a step: sums of J^T J, J^T r and r^T r over whitened rows.
struct Normal {
    Symmetric A{0, 0, 0, 0, 0, 0};
    Triple b{0, 0, 0};
    double squares = 0;
};
PLANLIGHT_INLINE void add_row(Normal& n, const Triple& j, double r) {
    n.A.xx += j.x * j.x;
    n.A.xy += j.x * j.y;
    n.A.xz += j.x * j.z;
    n.A.yy += j.y * j.y;
    n.A.yz += j.y * j.z;
    n.A.zz += j.z * j.z;
    n.b.x += j.x * r;
    n.b.y += j.y * r;
    n.b.z += j.z * r;
    n.squares += r * r;
}
PLANLIGHT_INLINE Triple scaled(const Triple& a, double s) {
    return {a.x * s, a.y * s, a.z * s};
}
/// a + s b + t c
PLANLIGHT_INLINE Triple sum(const Triple& a, double s, const Triple& b, double t, const Triple& c) {
    return {a.x + s * b.x + t * c.x, a.y + s * b.y + t * c.y, a.z + s * b.z + t * c.z};
}

PLANLIGHT_INLINE Symmetric inverse(const Symmetric& m) {
    const double xx = m.yy * m.zz - m.yz * m.yz, xy = m.xz * m.yz - m.xy * m.zz, xz = m.xy * m.yz - m.xz * m.yy;
    const double by_determinant = 1 / (m.xx * xx + m.xy * xy + m.xz * xz);
    return {xx * by_determinant,
            xy * by_determinant,
            xz * by_determinant,
            (m.xx * m.zz - m.xz * m.xz) * by_determinant,
            (m.xy * m.xz - m.xx * m.yz) * by_determinant,
            (m.xx * m.yy - m.xy * m.xy) * by_determinant};
}

PLANLIGHT_INLINE Symmetric square(const Symmetric& m) {
    return {m.xx * m.xx + m.xy * m.xy + m.xz * m.xz, m.xx * m.xy + m.xy * m.yy + m.xz * m.yz,
            m.xx * m.xz + m.xy * m.yz + m.xz * m.zz, m.xy * m.xy + m.yy * m.yy + m.yz * m.yz,
            m.xy * m.xz + m.yy * m.yz + m.yz * m.zz, m.xz * m.xz + m.yz * m.yz + m.zz * m.zz};
}

/// Solves the normal equations of point i and moves it.
PLANLIGHT_INLINE void step(const Normal& n, int i, Points& p, double good) {
    const Symmetric C = inverse(n.A);
    const Triple s{C.xx * n.b.x + C.xy * n.b.y + C.xz * n.b.z, C.xy * n.b.x + C.yy * n.b.y + C.yz * n.b.z,
                   C.xz * n.b.x + C.yz * n.b.y + C.zz * n.b.z};
    const double squared = dot(s, s), left_over = n.squares - dot(s, n.b);
    good = squared < 1e12 ? good : 0;  // NaN as well
    p.x[i] += good != 0 ? s.x : 0;
    p.y[i] += good != 0 ? s.y : 0;
    p.z[i] += good != 0 ? s.z : 0;
    p.cxx[i] = C.xx;
    p.cxy[i] = C.xy;
    p.cxz[i] = C.xz;
    p.cyy[i] = C.yy;
    p.cyz[i] = C.yz;
    p.czz[i] = C.zz;
    p.step_squared[i] = good != 0 ? squared : 0;
    p.residual_squared[i] = left_over > 0 ? left_over : 0;
    p.good[i] = good;
}

}  // namespace

Device::Device(const CameraModel& m)
    : fx(m.focal_x), fy(m.focal_y), cx(m.centre_x), cy(m.centre_y), k1(m.k1), k2(m.k2), p1(m.p1), p2(m.p2), k3(m.k3) {
    const Eigen::Vector3d centre = m.centre_in_rig();
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) r[3 * row + column] = m.device_from_rig.linear()(row, column);
        t[row] = m.device_from_rig.translation()(row);
        eye[row] = centre(row);
    }
}

PLANLIGHT_CLONES void start_three(const Device& left, const Device& right, const Device& projector, Points& p) {
    const Device l = left, r = right, d = projector;
    for (int i = 0; i < kLanes; ++i) {
        double good = 1, along = 0;
        const Triple u = direction_of(l, p.pixel_x[i], p.pixel_y[i], good),
                     v = direction_of(r, p.right_x[i], p.right_y[i], good);
        const Triple q = between(l, r, u, v, along, good);
        const Seen lit = see(d, q, good);
        // What remains of the difference to the right pixel across the direction in which depth moves it.
        along = (q.x - l.eye[0]) * u.x + (q.y - l.eye[1]) * u.y + (q.z - l.eye[2]) * u.z;
        const Seen seen = see(r, {l.eye[0] + along * u.x, l.eye[1] + along * u.y, l.eye[2] + along * u.z}, good);
        const double line_x = dot(seen.du, u), line_y = dot(seen.dv, u);
        const double across = line_x * (p.right_y[i] - seen.v) - line_y * (p.right_x[i] - seen.u);
        p.epipolar[i] = across / std::sqrt(line_x * line_x + line_y * line_y + 1e-30);
        p.offset_x[i] = p.code_x[i] - lit.u;
        p.offset_y[i] = p.code_y[i] - lit.v;
        p.x[i] = p.start_x[i] = q.x;
        p.y[i] = p.start_y[i] = q.y;
        p.z[i] = p.start_z[i] = q.z;
        p.good[i] = good;
    }
}

PLANLIGHT_CLONES void start_two(const Device& camera, const Device& projector, Points& p) {
    const Device c = camera, d = projector;
    for (int i = 0; i < kLanes; ++i) {
        double good = 1, along = 0;
        const Triple u = direction_of(c, p.pixel_x[i], p.pixel_y[i], good),
                     v = direction_of(d, p.code_x[i], p.code_y[i], good);
        const Triple q = between(c, d, u, v, along, good);
        p.x[i] = q.x;
        p.y[i] = q.y;
        p.z[i] = q.z;
        p.good[i] = good;
    }
}

PLANLIGHT_CLONES void adjust_three(const Device& left, const Device& right, const Device& projector,
                                   const Sigmas& sigmas, Points& p) {
    const Device l = left, r = right, d = projector;
    const double camera = sigmas.camera_px * sigmas.camera_px, lamp = sigmas.projector_px * sigmas.projector_px;
    const double by_camera = 1 / sigmas.camera_px;
    for (int i = 0; i < kLanes; ++i) {
        double good = p.good[i];
        const Triple q{p.x[i], p.y[i], p.z[i]};
        const Seen in_left = see(l, q, good), in_right = see(r, q, good), lit = see(d, q, good);
        Normal n;
        add_row(n, scaled(in_left.du, by_camera), (p.pixel_x[i] - in_left.u) * by_camera);
        add_row(n, scaled(in_left.dv, by_camera), (p.pixel_y[i] - in_left.v) * by_camera);
        const double left_code = p.sigma[i] * p.sigma[i], lamp_variance = lamp + left_code,
                     by_lamp = 1 / std::sqrt(lamp_variance);
        const double rx = p.code_x[i] - lit.u, ry = p.code_y[i] - lit.v;
        add_row(n, scaled(lit.du, by_lamp), rx * by_lamp);
        add_row(n, scaled(lit.dv, by_lamp), ry * by_lamp);
        // The right pixel, given the projector's: M = d right / d code shares the noise of the left code.
        const double mxx = p.by_code_xx[i], mxy = p.by_code_xy[i], myx = p.by_code_yx[i], myy = p.by_code_yy[i];
        const double share = left_code / lamp_variance;
        const double noise = left_code + p.right_sigma[i] * p.right_sigma[i] - left_code * share;
        const double kxx = camera + noise * (mxx * mxx + mxy * mxy), kxy = noise * (mxx * myx + mxy * myy);
        const double kyy = camera + noise * (myx * myx + myy * myy);
        const double by_lx = 1 / std::sqrt(kxx), lxy = kxy * by_lx, by_ly = 1 / std::sqrt(kyy - lxy * lxy);
        const Triple jx = sum(in_right.du, -share * mxx, lit.du, -share * mxy, lit.dv);
        const Triple jy = sum(in_right.dv, -share * myx, lit.du, -share * myy, lit.dv);
        const double ex = p.right_x[i] - in_right.u - share * (mxx * rx + mxy * ry);
        const double ey = p.right_y[i] - in_right.v - share * (myx * rx + myy * ry);
        const Triple whitened = scaled(jx, by_lx);
        const double whitened_e = ex * by_lx;
        add_row(n, whitened, whitened_e);
        add_row(n, scaled(sum(jy, -lxy, whitened, 0, whitened), by_ly), (ey - lxy * whitened_e) * by_ly);
        step(n, i, p, good);
    }
}

PLANLIGHT_CLONES void adjust_two(const Device& camera, const Device& projector, const Sigmas& sigmas, Points& p) {
    const Device c = camera, d = projector;
    const double by_camera = 1 / sigmas.camera_px, lamp = sigmas.projector_px * sigmas.projector_px;
    for (int i = 0; i < kLanes; ++i) {
        double good = p.good[i];
        const Triple q{p.x[i], p.y[i], p.z[i]};
        const Seen seen = see(c, q, good), lit = see(d, q, good);
        const double by_lamp = 1 / std::sqrt(lamp + p.sigma[i] * p.sigma[i]);
        Normal n;
        add_row(n, scaled(seen.du, by_camera), (p.pixel_x[i] - seen.u) * by_camera);
        add_row(n, scaled(seen.dv, by_camera), (p.pixel_y[i] - seen.v) * by_camera);
        add_row(n, scaled(lit.du, by_lamp), (p.code_x[i] - lit.u) * by_lamp);
        add_row(n, scaled(lit.dv, by_lamp), (p.code_y[i] - lit.v) * by_lamp);
        step(n, i, p, good);
    }
}

PLANLIGHT_CLONES void find_worst_sigma(Points& p) {
    for (int i = 0; i < kLanes; ++i) {
        const double trace = p.cxx[i] + p.cyy[i] + p.czz[i], s = 1 / trace;
        const Symmetric A{p.cxx[i] * s, p.cxy[i] * s, p.cxz[i] * s, p.cyy[i] * s, p.cyz[i] * s, p.czz[i] * s};
        // The traces of the 17th and 16th power: their ratio is the largest eigenvalue but for (second / first)^16.
        const Symmetric B = square(square(square(square(A))));
        const double high = B.xx * A.xx + B.yy * A.yy + B.zz * A.zz + 2 * (B.xy * A.xy + B.xz * A.xz + B.yz * A.yz);
        p.sigma_mm[i] = std::sqrt(trace * high / (B.xx + B.yy + B.zz));
    }
}

}  // namespace planlight::triangulate_kernel
