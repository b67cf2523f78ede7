#include "registration/scan/clean/neighbour_kernel.h"

#include <cmath>
#include <cstring>

#include "planning_io/types/processor_clones.h"

namespace planlight::neighbour_kernel {
namespace {

typedef float Lanes __attribute__((vector_size(4 * kLanes)));
typedef std::int32_t Mask __attribute__((vector_size(4 * kLanes)));

/// `kLanes` points from `k` on, as they lie from (x, y, z); which of them are within the reach and before `end`.
struct Near {
    Lanes dx, dy, dz;
    Mask within;
};

PLANLIGHT_INLINE void look(const Coordinates& points, std::uint32_t k, std::uint32_t end, float x, float y, float z,
                           float squared_reach, Near& near) {
    constexpr Mask kLane = {0, 1, 2, 3, 4, 5, 6, 7};
    std::memcpy(&near.dx, points.x + k, sizeof near.dx);
    std::memcpy(&near.dy, points.y + k, sizeof near.dy);
    std::memcpy(&near.dz, points.z + k, sizeof near.dz);
    near.dx -= x;
    near.dy -= y;
    near.dz -= z;
    near.within = (near.dx * near.dx + near.dy * near.dy + near.dz * near.dz <= squared_reach) &
                  (kLane < static_cast<std::int32_t>(end - k));
}

/// Symmetric: xx xy xz yy yz zz.
struct Symmetric {
    float xx, xy, xz, yy, yz, zz;
};
PLANLIGHT_INLINE Symmetric scaled(const Symmetric& m, float s) {
    return {m.xx * s, m.xy * s, m.xz * s, m.yy * s, m.yz * s, m.zz * s};
}
PLANLIGHT_INLINE Symmetric adjugate(const Symmetric& m) {
    return {m.yy * m.zz - m.yz * m.yz, m.xz * m.yz - m.xy * m.zz, m.xy * m.yz - m.xz * m.yy,
            m.xx * m.zz - m.xz * m.xz, m.xy * m.xz - m.xx * m.yz, m.xx * m.yy - m.xy * m.xy};
}
PLANLIGHT_INLINE Symmetric square(const Symmetric& m) {
    return {m.xx * m.xx + m.xy * m.xy + m.xz * m.xz, m.xx * m.xy + m.xy * m.yy + m.xz * m.yz,
            m.xx * m.xz + m.xy * m.yz + m.xz * m.zz, m.xy * m.xy + m.yy * m.yy + m.yz * m.yz,
            m.xy * m.xz + m.yy * m.yz + m.yz * m.zz, m.xz * m.xz + m.yz * m.yz + m.zz * m.zz};
}

}  // namespace

PLANLIGHT_CLONES int count_within(const Coordinates& points, const Run* runs, int run_count, std::uint32_t at,
                                  float reach) {
    const float x = points.x[at], y = points.y[at], z = points.z[at], squared = reach * reach;
    Near near;
    Mask count = {};
    for (int r = 0; r < run_count; ++r)
        for (std::uint32_t k = runs[r].begin; k < runs[r].end; k += kLanes) {
            look(points, k, runs[r].end, x, y, z, squared, near);
            count -= near.within;
        }
    int sum = 0;
    for (int i = 0; i < kLanes; ++i) sum += count[i];
    return sum;
}

PLANLIGHT_CLONES Sums sum_within(const Coordinates& points, const Run* runs, int run_count, std::uint32_t at,
                                 float reach) {
    const float px = points.x[at], py = points.y[at], pz = points.z[at], squared = reach * reach;
    Near near;
    const Lanes one = Lanes{} + 1;
    Lanes n = {}, x = {}, y = {}, z = {}, xx = {}, xy = {}, xz = {}, yy = {}, yz = {}, zz = {};
    for (int r = 0; r < run_count; ++r)
        for (std::uint32_t k = runs[r].begin; k < runs[r].end; k += kLanes) {
            look(points, k, runs[r].end, px, py, pz, squared, near);
            const Mask use = near.within;
            const Lanes dx = (Lanes)((Mask)near.dx & use), dy = (Lanes)((Mask)near.dy & use),
                        dz = (Lanes)((Mask)near.dz & use);
            n += (Lanes)((Mask)one & use);
            x += dx;
            y += dy;
            z += dz;
            xx += dx * dx;
            xy += dx * dy;
            xz += dx * dz;
            yy += dy * dy;
            yz += dy * dz;
            zz += dz * dz;
        }
    Sums s;
    for (int i = 0; i < kLanes; ++i) {
        s.n += n[i];
        s.x += x[i];
        s.y += y[i];
        s.z += z[i];
        s.xx += xx[i];
        s.xy += xy[i];
        s.xz += xz[i];
        s.yy += yy[i];
        s.yz += yz[i];
        s.zz += zz[i];
    }
    return s;
}

PLANLIGHT_CLONES void find_planes(Planes& p) {
    for (int i = 0; i < kPlanes; ++i) {
        const float n = p.n[i], by_n = 1 / (n > 1 ? n : 1), x = p.x[i] * by_n, y = p.y[i] * by_n, z = p.z[i] * by_n;
        const Symmetric C{p.xx[i] - p.x[i] * x, p.xy[i] - p.x[i] * y, p.xz[i] - p.x[i] * z,
                          p.yy[i] - p.y[i] * y, p.yz[i] - p.y[i] * z, p.zz[i] - p.z[i] * z};
        const float scatter = C.xx + C.yy + C.zz;
        const Symmetric A = adjugate(scaled(C, 1 / (scatter > 0 ? scatter : 1)));
        const float plane = A.xx + A.yy + A.zz;  // largest times middle eigenvalue
        const bool good = bool((n >= 6) & (scatter > 0) & (plane > 1e-6f));
        const Symmetric B = square(square(scaled(A, 1 / (good ? plane : 1))));
        const bool first = bool((B.xx >= B.yy) & (B.xx >= B.zz)), second = bool(!first & (B.yy >= B.zz));
        const float nx = first    ? B.xx
                         : second ? B.xy
                                  : B.xz,
                    ny = first    ? B.xy
                         : second ? B.yy
                                  : B.yz,
                    nz = first    ? B.xz
                         : second ? B.yz
                                  : B.zz;
        const float squares = nx * nx + ny * ny + nz * nz, by_length = good ? 1 / std::sqrt(squares) : 0;
        p.normal_x[i] = nx * by_length;
        p.normal_y[i] = ny * by_length;
        p.normal_z[i] = nz * by_length;
    }
}

}  // namespace planlight::neighbour_kernel
