#include "registration/scan/neighbour_kernel.h"

#include <cstring>

#include "registration/processor_clones.h"

namespace planlight::neighbour_kernel {
namespace {

typedef float Lanes __attribute__((vector_size(4 * kLanes)));
typedef std::int32_t Mask __attribute__((vector_size(4 * kLanes)));

}  // namespace

PLANLIGHT_CLONES int count_within(const Coordinates& points, const Run* runs, int run_count, std::uint32_t at, float reach) {
    const float x = points.x[at], y = points.y[at], z = points.z[at], squared = reach * reach;
    const Mask lane = {0, 1, 2, 3, 4, 5, 6, 7};
    Mask count = {};
    for (int r = 0; r < run_count; ++r)
        for (std::uint32_t k = runs[r].begin; k < runs[r].end; k += kLanes) {
            Lanes dx, dy, dz;
            std::memcpy(&dx, points.x + k, sizeof dx);
            std::memcpy(&dy, points.y + k, sizeof dy);
            std::memcpy(&dz, points.z + k, sizeof dz);
            dx -= x;
            dy -= y;
            dz -= z;
            count -= (dx * dx + dy * dy + dz * dz <= squared) & (lane < static_cast<std::int32_t>(runs[r].end - k));
        }
    int sum = 0;
    for (int i = 0; i < kLanes; ++i) sum += count[i];
    return sum;
}

PLANLIGHT_CLONES Sums sum_within(const Coordinates& points, const Run* runs, int run_count, std::uint32_t at, float reach) {
    const float px = points.x[at], py = points.y[at], pz = points.z[at], squared = reach * reach;
    const Mask lane = {0, 1, 2, 3, 4, 5, 6, 7};
    const Lanes one = Lanes{} + 1;
    Lanes n = {}, x = {}, y = {}, z = {}, xx = {}, xy = {}, xz = {}, yy = {}, yz = {}, zz = {};
    for (int r = 0; r < run_count; ++r)
        for (std::uint32_t k = runs[r].begin; k < runs[r].end; k += kLanes) {
            Lanes dx, dy, dz;
            std::memcpy(&dx, points.x + k, sizeof dx);
            std::memcpy(&dy, points.y + k, sizeof dy);
            std::memcpy(&dz, points.z + k, sizeof dz);
            dx -= px;
            dy -= py;
            dz -= pz;
            const Mask use = (dx * dx + dy * dy + dz * dz <= squared) & (lane < static_cast<std::int32_t>(runs[r].end - k));
            dx = (Lanes)((Mask)dx & use);
            dy = (Lanes)((Mask)dy & use);
            dz = (Lanes)((Mask)dz & use);
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
