#include "registration/simulation/blur.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace planlight::simulation {

namespace {

/// out[i] = sum of kernel[|k|] * in[i + k * stride], for a whole row, where all taps are inside `in`.
__attribute__((target_clones("avx512f", "avx2", "default"))) void add_row(float* out, const float* in, float weight,
                                                                          std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) out[i] += weight * in[i];
}

/// Mean of 2 radius + 1 pixels, along a row.
void mean_row(const float* in, float* out, int n, int radius) {
    const float scale = 1.0F / static_cast<float>(2 * radius + 1);
    float sum = 0;
    for (int i = 0; i < std::min(radius, n); ++i) sum += in[i];
    for (int i = 0; i < n; ++i) {
        if (i + radius < n) sum += in[i + radius];
        if (i - radius - 1 >= 0) sum -= in[i - radius - 1];
        out[i] = std::max(0.0F, sum * scale);
    }
}

}  // namespace

void gaussian_blur(std::vector<float>& picture, std::vector<float>& scratch, int width, int height, double sigma_px) {
    const int radius = std::max(1, static_cast<int>(std::ceil(3 * sigma_px)));
    std::vector<float> kernel(static_cast<std::size_t>(radius) + 1);
    double sum = 0;
    for (int k = -radius; k <= radius; ++k) sum += std::exp(-k * k / (2 * sigma_px * sigma_px));
    for (int k = 0; k <= radius; ++k)
        kernel[static_cast<std::size_t>(k)] = static_cast<float>(std::exp(-k * k / (2 * sigma_px * sigma_px)) / sum);
    scratch.resize(picture.size());
    const auto row_of = [width](std::vector<float>& p, int y) {
        return p.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
    };
    tbb::parallel_for(tbb::blocked_range<int>(0, height, 16), [&](const tbb::blocked_range<int>& rows) {
        for (int y = rows.begin(); y < rows.end(); ++y) {
            const float* in = row_of(picture, y);
            float* out = row_of(scratch, y);
            std::fill_n(out, width, 0.0F);
            for (int k = -radius; k <= radius; ++k) {
                const int from = std::max(0, -k), to = std::min(width, width - k);
                if (to > from)
                    add_row(out + from, in + from + k, kernel[static_cast<std::size_t>(std::abs(k))],
                            static_cast<std::size_t>(to - from));
            }
        }
    });
    tbb::parallel_for(tbb::blocked_range<int>(0, height, 16), [&](const tbb::blocked_range<int>& rows) {
        for (int y = rows.begin(); y < rows.end(); ++y) {
            float* out = row_of(picture, y);
            std::fill_n(out, width, 0.0F);
            for (int k = -radius; k <= radius; ++k)
                if (y + k >= 0 && y + k < height)
                    add_row(out, row_of(scratch, y + k), kernel[static_cast<std::size_t>(std::abs(k))],
                            static_cast<std::size_t>(width));
        }
    });
}

void wide_blur(std::vector<float>& picture, std::vector<float>& scratch, int width, int height, int radius) {
    scratch.resize(picture.size());
    const auto w = static_cast<std::size_t>(width);
    for (int pass = 0; pass < 2; ++pass) {
        tbb::parallel_for(tbb::blocked_range<int>(0, height, 16), [&](const tbb::blocked_range<int>& rows) {
            for (int y = rows.begin(); y < rows.end(); ++y)
                mean_row(picture.data() + static_cast<std::size_t>(y) * w,
                         scratch.data() + static_cast<std::size_t>(y) * w, width, radius);
        });
        // Down the columns, a band of them at a time, with running sums.
        tbb::parallel_for(tbb::blocked_range<int>(0, width, 128), [&](const tbb::blocked_range<int>& band) {
            const auto from = static_cast<std::size_t>(band.begin()), n = static_cast<std::size_t>(band.size());
            const float scale = 1.0F / static_cast<float>(2 * radius + 1);
            std::vector<float> sum(n, 0);
            const auto row = [&](int y) { return scratch.data() + static_cast<std::size_t>(y) * w + from; };
            for (int y = 0; y < std::min(radius, height); ++y) add_row(sum.data(), row(y), 1, n);
            for (int y = 0; y < height; ++y) {
                if (y + radius < height) add_row(sum.data(), row(y + radius), 1, n);
                if (y - radius - 1 >= 0) add_row(sum.data(), row(y - radius - 1), -1, n);
                float* out = picture.data() + static_cast<std::size_t>(y) * w + from;
                for (std::size_t i = 0; i < n; ++i) out[i] = std::max(0.0F, sum[i] * scale);
            }
        });
    }
}

}  // namespace planlight::simulation
