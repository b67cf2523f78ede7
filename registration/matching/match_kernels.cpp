#include "registration/matching/match_kernels.h"

#include <algorithm>
#include <cmath>

#include "planning_io/types/processor_clones.h"

// Compiled with -fassociative-math (see CMakeLists.txt), so that the sums may run in parallel lanes. The points are
// finite.
namespace planlight::match_kernels {
namespace {

constexpr std::size_t kBlock = 128;

/// One block of points: the trilinear distance and its gradient (in mm per node), and whether the field holds them.
struct Samples {
    float arm_x[kBlock], arm_y[kBlock], arm_z[kBlock];
    float mm[kBlock], gx[kBlock], gy[kBlock], gz[kBlock];
    float holds[kBlock];  // 1 or 0
};

PLANLIGHT_INLINE void sample(const float* x, const float* y, const float* z, std::size_t n, const Field& field,
                             const Placing& placing, Samples& s) {
    const float* R = placing.R;
    const float ax = placing.arm_shift[0], ay = placing.arm_shift[1], az = placing.arm_shift[2];
    const float bx = placing.shift[0], by = placing.shift[1], bz = placing.shift[2];
    const float per_mm = field.per_mm, end_x = field.end_x, end_y = field.end_y, end_z = field.end_z;
    const float last_x = std::nextafter(end_x, 0.f), last_y = std::nextafter(end_y, 0.f),
                last_z = std::nextafter(end_z, 0.f);
    const int row = field.stride_y, slab = field.stride_z;
    const float* values = field.mm;
    for (std::size_t i = 0; i < n; ++i) {
        const float rx = R[0] * x[i] + R[1] * y[i] + R[2] * z[i];
        const float ry = R[3] * x[i] + R[4] * y[i] + R[5] * z[i];
        const float rz = R[6] * x[i] + R[7] * y[i] + R[8] * z[i];
        s.arm_x[i] = rx + ax;
        s.arm_y[i] = ry + ay;
        s.arm_z[i] = rz + az;
        const float vx = per_mm * (rx + bx), vy = per_mm * (ry + by), vz = per_mm * (rz + bz);
        const bool holds = (vx >= 0) & (vy >= 0) & (vz >= 0) & (vx < end_x) & (vy < end_y) & (vz < end_z);
        const float hx = std::min(std::max(vx, 0.f), last_x), hy = std::min(std::max(vy, 0.f), last_y),
                    hz = std::min(std::max(vz, 0.f), last_z);
        const int cx = static_cast<int>(hx), cy = static_cast<int>(hy), cz = static_cast<int>(hz);
        const float fx = hx - static_cast<float>(cx), fy = hy - static_cast<float>(cy),
                    fz = hz - static_cast<float>(cz);
        const int at = cx + cy * row + cz * slab;
        const float v000 = values[at], v100 = values[at + 1], v010 = values[at + row], v110 = values[at + row + 1];
        const float v001 = values[at + slab], v101 = values[at + slab + 1], v011 = values[at + slab + row],
                    v111 = values[at + slab + row + 1];
        const float s00 = v100 - v000, s10 = v110 - v010, s01 = v101 - v001, s11 = v111 - v011;
        const float e00 = v000 + fx * s00, e10 = v010 + fx * s10, e01 = v001 + fx * s01, e11 = v011 + fx * s11;
        const float low = e00 + fy * (e10 - e00), high = e01 + fy * (e11 - e01);
        const float near = s00 + fy * (s10 - s00), far = s01 + fy * (s11 - s01);
        s.mm[i] = low + fz * (high - low);
        s.gx[i] = near + fz * (far - near);
        s.gy[i] = (e10 - e00) + fz * ((e11 - e01) - (e10 - e00));
        s.gz[i] = high - low;
        s.holds[i] = holds ? 1.f : 0.f;
    }
}

}  // namespace

PLANLIGHT_CLONES std::size_t add_point_to_plane(const float* x, const float* y, const float* z,
                                                const std::uint8_t* skip, std::size_t n, const Field& field,
                                                const Placing& placing, const Gate& gate, double* sums) {
    constexpr float kRidge = 0.3f;  // slope below which the field has no side to go to
    const float to_inside = 1 / (4.685f * gate.scale_inside_mm), to_outside = 1 / (4.685f * gate.scale_outside_mm);
    const float per_mm = field.per_mm, max_mm = gate.max_mm;
    Samples s;
    float part[kBlock];
    float used = 0;
    for (std::size_t first = 0; first < n; first += kBlock) {
        const std::size_t m = std::min(kBlock, n - first);
        sample(x + first, y + first, z + first, m, field, placing, s);
        for (std::size_t i = 0; i < m; ++i) part[i] = s.holds[i];
        if (skip)
            for (std::size_t i = 0; i < m; ++i) part[i] = skip[first + i] ? 0.f : part[i];
        float h[27] = {};
        float block_used = 0;
        for (std::size_t i = 0; i < m; ++i) {
            const float d = s.mm[i];
            const float squared = per_mm * per_mm * (s.gx[i] * s.gx[i] + s.gy[i] * s.gy[i] + s.gz[i] * s.gz[i]);
            const float takes = (std::abs(d) <= max_mm) & (squared >= kRidge * kRidge) ? part[i] : 0.f;
            block_used += takes;
            const float u = d * (d > 0 ? to_outside : to_inside);
            const float v = std::max(1 - u * u, 0.f);
            const float w = takes * v * v;
            const float by = per_mm / std::sqrt(std::max(squared, kRidge * kRidge));
            const float nx = s.gx[i] * by, ny = s.gy[i] * by, nz = s.gz[i] * by;
            const float tx = s.arm_y[i] * nz - s.arm_z[i] * ny, ty = s.arm_z[i] * nx - s.arm_x[i] * nz,
                        tz = s.arm_x[i] * ny - s.arm_y[i] * nx;
            const float wtx = w * tx, wty = w * ty, wtz = w * tz, wnx = w * nx, wny = w * ny, wnz = w * nz;
            h[0] += wtx * tx, h[1] += wtx * ty, h[2] += wtx * tz, h[3] += wtx * nx, h[4] += wtx * ny, h[5] += wtx * nz;
            h[6] += wty * ty, h[7] += wty * tz, h[8] += wty * nx, h[9] += wty * ny, h[10] += wty * nz;
            h[11] += wtz * tz, h[12] += wtz * nx, h[13] += wtz * ny, h[14] += wtz * nz;
            h[15] += wnx * nx, h[16] += wnx * ny, h[17] += wnx * nz;
            h[18] += wny * ny, h[19] += wny * nz;
            h[20] += wnz * nz;
            h[21] += wtx * d, h[22] += wty * d, h[23] += wtz * d, h[24] += wnx * d, h[25] += wny * d, h[26] += wnz * d;
        }
        used += block_used;
        for (std::size_t k = 0; k < 27; ++k) sums[k] += static_cast<double>(h[k]);
    }
    return static_cast<std::size_t>(used);
}

PLANLIGHT_CLONES double sum_failure(const float* x, const float* y, const float* z, const float* nx, const float* ny,
                                    const float* nz, std::size_t n, const Field& field, const Placing& placing,
                                    float inside_mm, float outside_mm, float beyond_mm) {
    const float* R = placing.R;
    Samples s;
    double sum = 0;
    for (std::size_t first = 0; first < n; first += kBlock) {
        const std::size_t m = std::min(kBlock, n - first);
        sample(x + first, y + first, z + first, m, field, placing, s);
        float of_block = 0;
        for (std::size_t i = 0; i < m; ++i) {
            const std::size_t k = first + i;
            const float facing = s.gx[i] * (R[0] * nx[k] + R[1] * ny[k] + R[2] * nz[k]) +
                                 s.gy[i] * (R[3] * nx[k] + R[4] * ny[k] + R[5] * nz[k]) +
                                 s.gz[i] * (R[6] * nx[k] + R[7] * ny[k] + R[8] * nz[k]);
            const float d = s.mm[i];
            const float off = d > 0 ? std::min(d, outside_mm) : std::min(-d, inside_mm);
            of_block += s.holds[i] > 0 ? (facing > 0 ? off : inside_mm) : beyond_mm;
        }
        sum += static_cast<double>(of_block);
    }
    return sum;
}

PLANLIGHT_CLONES void mark_alike(const float* length_mm, const float* first, const float* second, const float* between,
                                 std::size_t n, const PairGate& wanted, std::uint8_t* marks) {
    const PairGate w = wanted;
    for (std::size_t i = 0; i < n; ++i)
        marks[i] = (std::abs(length_mm[i] - w.length_mm) < w.length_tolerance_mm) &
                   (std::abs(first[i] - w.first) < w.cosine_tolerance) &
                   (std::abs(second[i] - w.second) < w.cosine_tolerance) &
                   (std::abs(between[i] - w.between) < w.cosine_tolerance);
}

}  // namespace planlight::match_kernels
