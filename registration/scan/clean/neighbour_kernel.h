#pragma once

#include <cstdint>

// Sums over the neighbours of a point, several neighbours side by side. Private to registration/scan.
namespace planlight::neighbour_kernel {

/// Points side by side in one register at most.
inline constexpr int kLanes = 8;

/// Places [begin, end) of the points' arrays, one run a line of cells.
struct Run {
    std::uint32_t begin, end;
};

/// Coordinates (mm) as three arrays with kLanes more entries than points; NaN is a point that is no longer there.
struct Coordinates {
    const float *x, *y, *z;
};

/// How many of the points in the runs lie within `reach` of point `at` (itself among them).
int count_within(const Coordinates& points, const Run* runs, int run_count, std::uint32_t at, float reach);

/// Number, sum and sum of squares of the differences to point `at`, of the points within `reach`.
struct Sums {
    float n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
};
Sums sum_within(const Coordinates& points, const Run* runs, int run_count, std::uint32_t at, float reach);

/// The sums of up to kPlanes points, side by side, and the planes through them.
inline constexpr int kPlanes = 64;
struct alignas(64) Planes {
    float n[kPlanes], x[kPlanes], y[kPlanes], z[kPlanes], xx[kPlanes], xy[kPlanes], xz[kPlanes], yy[kPlanes],
        yz[kPlanes], zz[kPlanes];
    /// The direction in which the points scatter least, unit length; zero when they are under six or do not span a
    /// plane.
    float normal_x[kPlanes], normal_y[kPlanes], normal_z[kPlanes];

    void set(int place, const Sums& sums) {
        n[place] = sums.n, x[place] = sums.x, y[place] = sums.y, z[place] = sums.z;
        xx[place] = sums.xx, xy[place] = sums.xy, xz[place] = sums.xz;
        yy[place] = sums.yy, yz[place] = sums.yz, zz[place] = sums.zz;
    }
};

/// The adjugate of the points' covariance has its eigenvectors, the one of the least scatter foremost; its fourth power
/// has hardly anything else.
void find_planes(Planes& planes);

}  // namespace planlight::neighbour_kernel
