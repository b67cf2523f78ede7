#include "registration/scan/decode/smooth_cells.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "planning_io/types/processor_clones.h"

namespace planlight {
namespace {

/// Sums of a plane's fit at the pixels of a line, side by side. Places are from the pixel, values from its own.
struct Sums {
    std::vector<float> n, x, y, xx, xy, yy, v, vx, vy;
    explicit Sums(std::size_t width)
        : n(width), x(width), y(width), xx(width), xy(width), yy(width), v(width), vx(width), vy(width) {}
    void clear() {
        for (auto* sum : {&n, &x, &y, &xx, &xy, &yy, &v, &vx, &vy}) std::fill(sum->begin(), sum->end(), 0.0F);
    }
};

/// The neighbours at one place (dx, dy) from each of `count` pixels.
PLANLIGHT_CLONES void add_neighbours(const float* here, const float* there, float dx, float dy, float jump,
                                     float* __restrict n, float* __restrict x, float* __restrict y,
                                     float* __restrict xx, float* __restrict xy, float* __restrict yy,
                                     float* __restrict v, float* __restrict vx, float* __restrict vy,
                                     std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        const float d = there[i] - here[i];
        const bool part = (d <= jump) & (d >= -jump);  // not where either is NaN
        const float one = part ? 1.0F : 0.0F, value = part ? d : 0.0F;
        n[i] += one;
        x[i] += one * dx;
        y[i] += one * dy;
        xx[i] += one * (dx * dx);
        xy[i] += one * (dx * dy);
        yy[i] += one * (dy * dy);
        v[i] += value;
        vx[i] += value * dx;
        vy[i] += value * dy;
    }
}

/// The planes' values at the pixels themselves, by Cramer's rule.
PLANLIGHT_CLONES void solve(const float* here, const Sums& s, float least, float most_off, float* code,
                            std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        const float n = s.n[i], x = s.x[i], y = s.y[i], xx = s.xx[i], xy = s.xy[i], yy = s.yy[i];
        const float a = xx * yy - xy * xy, b = xy * y - x * yy, c = x * xy - xx * y;
        const float determinant = n * a + x * b + y * c;
        const bool determined = (n >= least) & (determinant > 1e-5F * n * xx * yy);
        const float off = (a * s.v[i] + b * s.vx[i] + c * s.vy[i]) / (determined ? determinant : 1.0F);
        const bool good = determined & (off <= most_off) & (off >= -most_off);
        code[i] = good ? here[i] + off : std::numeric_limits<float>::quiet_NaN();
    }
}

}  // namespace

void smooth_cells(const std::vector<float>& cells, int width, int height, int reach, float cell_px,
                  std::vector<float>& code) {
    const int step = std::max(1, reach / 4);
    const auto side = static_cast<float>(2 * (reach / step) + 1);
    const float jump = 4 * cell_px + 4, least = 0.4F * side * side;
    const auto line = [&](int y) { return static_cast<std::ptrdiff_t>(y) * width; };
    tbb::parallel_for(tbb::blocked_range<int>(0, height, 8), [&](const tbb::blocked_range<int>& rows) {
        Sums s(static_cast<std::size_t>(width));
        for (int y = rows.begin(); y < rows.end(); ++y) {
            const float* here = cells.data() + line(y);
            if (std::all_of(here, here + width, [](float c) { return std::isnan(c); }))
                continue;  // `code` stays as it is
            s.clear();
            for (int dy = -reach / step * step; dy <= reach; dy += step) {
                if (y + dy < 0 || y + dy >= height) continue;
                for (int dx = -reach / step * step; dx <= reach; dx += step) {
                    const int first = std::max(0, -dx), end = std::min(width, width - dx);
                    if (first >= end) continue;
                    const auto f = static_cast<std::size_t>(first);
                    add_neighbours(here + first, cells.data() + line(y + dy) + first + dx, static_cast<float>(dx),
                                   static_cast<float>(dy), jump, &s.n[f], &s.x[f], &s.y[f], &s.xx[f], &s.xy[f],
                                   &s.yy[f], &s.v[f], &s.vx[f], &s.vy[f], static_cast<std::size_t>(end - first));
                }
            }
            solve(here, s, least, 1.5F * cell_px, code.data() + line(y), static_cast<std::size_t>(width));
        }
    });
}

}  // namespace planlight
