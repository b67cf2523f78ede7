#include "segmentation/nearest_transform.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "segmentation/skin_voxels.h"

namespace planlight {
namespace {

/// Along one line: which position `p` has the least (q - p)^2 + squared[p], for every q (lower envelope of parabolas).
class Envelope {
public:
    explicit Envelope(int n) : position_(static_cast<std::size_t>(n)), height_(position_.size()), start_(position_.size()) {}

    void clear() { count_ = 0; }

    /// Adds the parabola of `p`; positions must rise.
    void add(std::int32_t p, std::int32_t squared) {
        const std::int32_t height = squared + p * p;
        std::int32_t from = 0;
        while (count_ > 0) {
            const std::size_t top = count_ - 1;
            // The new parabola is the lower one from the first q with 2 q (p - p_top) > height - height_top.
            const std::int32_t difference = height - height_[top], twice = 2 * (p - position_[top]);
            from = difference < 0 ? 0 : difference / twice + 1;
            if (from > start_[top]) break;
            --count_;
            from = 0;
        }
        position_[count_] = p;
        height_[count_] = height;
        start_[count_] = from;
        ++count_;
    }

    /// Calls `put(q, p)` for q = 0..n-1 with the nearest p. Nothing when there is no parabola.
    template <class Put>
    void read(int n, Put&& put) const {
        for (std::size_t c = 0; c < count_; ++c) {
            const std::int32_t end = c + 1 < count_ ? std::min(start_[c + 1], n) : n;
            for (std::int32_t q = start_[c]; q < end; ++q) put(q, position_[c]);
        }
    }

private:
    std::vector<std::int32_t> position_, height_, start_;
    std::size_t count_ = 0;
};

struct Table {
    std::uint32_t* nearest;
    std::array<int, 3> size;
    std::size_t row, slab;
    std::vector<std::array<std::int32_t, 3>> voxel;  // of each skin point

    explicit Table(SkinLut& lut)
        : nearest(lut.nearest.data()), size(lut.size), row(static_cast<std::size_t>(size[0])),
          slab(row * static_cast<std::size_t>(size[1])), voxel(lut.skin.size()) {
        for (std::size_t s = 0; s < voxel.size(); ++s)
            for (std::size_t a = 0; a < 3; ++a) voxel[s][a] = lut.skin[s].voxel[a];
    }
};

/// Nearest skin voxel of the same row: two sweeps.
void along_row(const Table& table, std::uint32_t* line) {
    std::uint32_t last = kNoSkin;
    std::int32_t last_i = 0;
    for (std::int32_t i = 0; i < table.size[0]; ++i) {
        if (line[i] == kNoSkin) continue;
        const std::int32_t middle = last == kNoSkin ? 0 : (last_i + i) / 2 + 1;
        for (std::int32_t b = last == kNoSkin ? 0 : last_i + 1; b < i; ++b) line[b] = b < middle && last != kNoSkin ? last : line[i];
        last = line[i];
        last_i = i;
    }
    if (last != kNoSkin) std::fill(line + last_i + 1, line + table.size[0], last);
}

/// `lines` neighbouring lines with stride `stride` along `axis`; each entry points to the nearest skin voxel so far.
void along_lines(const Table& table, std::size_t first, std::size_t lines, std::size_t stride, std::size_t axis, int i0,
                 int j0) {
    const int n = table.size[axis];
    Envelope envelope(n);
    std::vector<std::uint32_t> block(static_cast<std::size_t>(n) * lines);
    for (std::size_t q = 0; q < static_cast<std::size_t>(n); ++q)
        std::copy_n(table.nearest + first + q * stride, lines, block.data() + q * lines);
    std::vector<std::uint32_t> line(static_cast<std::size_t>(n));
    for (std::size_t l = 0; l < lines; ++l) {
        envelope.clear();
        const std::int32_t i = i0 + static_cast<std::int32_t>(l);
        for (std::int32_t p = 0; p < n; ++p) {
            const std::uint32_t s = block[static_cast<std::size_t>(p) * lines + l];
            line[static_cast<std::size_t>(p)] = s;
            if (s == kNoSkin) continue;
            const std::int32_t di = i - table.voxel[s][0];
            const std::int32_t dj = axis == 2 ? j0 - table.voxel[s][1] : 0;
            envelope.add(p, di * di + dj * dj);
        }
        envelope.read(n, [&](std::int32_t q, std::int32_t p) {
            block[static_cast<std::size_t>(q) * lines + l] = line[static_cast<std::size_t>(p)];
        });
    }
    for (std::size_t q = 0; q < static_cast<std::size_t>(n); ++q)
        std::copy_n(block.data() + q * lines, lines, table.nearest + first + q * stride);
}

constexpr std::size_t kLines = 16;  // one cache line of pointers

void along_columns(const Table& table, std::size_t base, std::size_t stride, std::size_t axis, int j) {
    for (std::size_t i = 0; i < table.row; i += kLines)
        along_lines(table, base + i, std::min(kLines, table.row - i), stride, axis, static_cast<int>(i), j);
}

}  // namespace

void point_to_nearest(SkinLut& lut) {
    const Table table(lut);
    tbb::parallel_for(0, table.size[2], [&](int k) {
        const std::size_t base = static_cast<std::size_t>(k) * table.slab;
        for (int j = 0; j < table.size[1]; ++j) along_row(table, table.nearest + base + static_cast<std::size_t>(j) * table.row);
        along_columns(table, base, table.row, 1, 0);
    });
    tbb::parallel_for(0, table.size[1], [&](int j) {
        along_columns(table, static_cast<std::size_t>(j) * table.row, table.slab, 2, j);
    });
}

}  // namespace planlight
