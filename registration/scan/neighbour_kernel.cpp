#include "registration/scan/neighbour_kernel.h"

#include <cstring>

#include "registration/processor_clones.h"

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

}  // namespace

PLANLIGHT_CLONES int count_within(const Coordinates& points, const Run* runs, int run_count, std::uint32_t at, float reach) {
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

PLANLIGHT_CLONES Sums sum_within(const Coordinates& points, const Run* runs, int run_count, std::uint32_t at, float reach) {
    const float px = points.x[at], py = points.y[at], pz = points.z[at], squared = reach * reach;
    Near near;
    const Lanes one = Lanes{} + 1;
    Lanes n = {}, x = {}, y = {}, z = {}, xx = {}, xy = {}, xz = {}, yy = {}, yz = {}, zz = {};
    for (int r = 0; r < run_count; ++r)
        for (std::uint32_t k = runs[r].begin; k < runs[r].end; k += kLanes) {
            look(points, k, runs[r].end, px, py, pz, squared, near);
            const Mask use = near.within;
            const Lanes dx = (Lanes)((Mask)near.dx & use), dy = (Lanes)((Mask)near.dy & use), dz = (Lanes)((Mask)near.dz & use);
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

}  // namespace planlight::neighbour_kernel
