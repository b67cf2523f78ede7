#include "segmentation/nearest_transform.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <stdexcept>

#include "segmentation/nearest_passes.h"

namespace planlight {
namespace {

using namespace nearest_passes;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

template <class Key>
const Passes<Key>& passes_for(VectorPath path) {
    constexpr bool kNarrow = sizeof(Key) == 4;
    if (path == VectorPath::best)
        path = can_use(VectorPath::avx512) ? VectorPath::avx512
               : can_use(VectorPath::avx2) ? VectorPath::avx2
                                           : VectorPath::plain;
    if (!can_use(path)) throw std::logic_error("this processor does not have the instructions asked for");
    if constexpr (kNarrow)
        return path == VectorPath::avx512 ? kAvx512 : path == VectorPath::avx2 ? kAvx2 : kPlain;
    else
        return path == VectorPath::avx512 ? kAvx512Wide : path == VectorPath::avx2 ? kAvx2Wide : kPlainWide;
}

/// The skin voxels by rows of the table.
struct SkinRows {
    std::vector<std::uint32_t> begin;  // of each row; one more
    std::vector<std::uint16_t> x;
    std::vector<int> slices;  // with skin

    explicit SkinRows(const SkinLut& lut) : begin(at(lut.size[1]) * at(lut.size[2]) + 1), x(lut.skin.size()) {
        std::size_t row = 0;
        const std::uint16_t* before = nullptr;
        for (std::size_t s = 0; s < x.size(); ++s) {
            const auto& v = lut.skin[s].voxel;
            const std::size_t row_of_voxel = at(v[2]) * at(lut.size[1]) + v[1];
            if (v[0] >= lut.size[0] || v[1] >= lut.size[1] || v[2] >= lut.size[2] || row_of_voxel + 1 < row ||
                (row_of_voxel + 1 == row && *before >= v[0]))
                throw std::logic_error("the skin voxels are not in the order of the table");
            for (; row <= row_of_voxel; ++row) begin[row] = static_cast<std::uint32_t>(s);
            x[s] = v[0];
            before = &x[s];
            if (slices.empty() || slices.back() != v[2]) slices.push_back(v[2]);
        }
        for (; row < begin.size(); ++row) begin[row] = static_cast<std::uint32_t>(x.size());
    }
};

/// squares[d] for d = -n .. n + kLanes at [n + d], in the keys' upper bits.
template <class Key>
std::vector<Key> squares_of(int n, unsigned bits) {
    std::vector<Key> squares;
    for (std::int64_t d = -n; d <= n + kLanes; ++d)
        squares.push_back(static_cast<Key>(static_cast<std::uint64_t>(d * d) << bits));
    return squares;
}

template <class Key>
void transform(SkinLut& lut, const SkinRows& rows, unsigned bits, VectorPath path) {
    const Passes<Key>& passes = passes_for<Key>(path);
    const int longest = *std::max_element(lut.size.begin(), lut.size.end());
    const std::vector<Key> squares = squares_of<Key>(longest, bits);
    const std::size_t row_step =
        (rows.slices.size() + 1) * kLanes;  // one more: no power of two, which would crowd the caches
    LargeArray<Key> keys(row_step * at(lut.size[1]));
    LargeArray<std::uint32_t> skin(keys.size());
    Stripe<Key> stripe{.size_x = lut.size[0],
                       .size_y = lut.size[1],
                       .size_z = lut.size[2],
                       .x0 = 0,
                       .bits = bits,
                       .squares = squares.data() + longest,
                       .row_begin = rows.begin.data(),
                       .skin_x = rows.x.data(),
                       .slices = rows.slices.data(),
                       .slice_count = static_cast<int>(rows.slices.size()),
                       .row_step = row_step,
                       .keys = keys.data(),
                       .skin = skin.data(),
                       .nearest = lut.nearest.data()};
    const std::size_t scratch = scratch_bytes<Key>(lut.size[1], lut.size[2]);
    const auto for_all = [&](int count, auto&& pass) {
        tbb::parallel_for(tbb::blocked_range<int>(0, count, 4), [&](const tbb::blocked_range<int>& range) {
            thread_local LargeArray<std::byte> buffer;
            if (buffer.size() < scratch) buffer = LargeArray<std::byte>(scratch);
            for (int i = range.begin(); i < range.end(); ++i) pass(stripe, i, buffer.data());
        });
    };
    for (; stripe.x0 < stripe.size_x; stripe.x0 += kLanes) {
        for_all(stripe.slice_count, passes.in_slice);
        for_all(stripe.size_y, passes.across_slices);
    }
}

}  // namespace

bool can_use(VectorPath path) {
    switch (path) {
        case VectorPath::avx512:
            return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                   __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
        case VectorPath::avx2:
            return __builtin_cpu_supports("avx2");
        default:
            return true;
    }
}

void point_to_nearest(SkinLut& lut, VectorPath path) {
    if (lut.skin.empty()) throw std::logic_error("a table needs a skin");
    const SkinRows rows(lut);
    lut.nearest = {};
    lut.nearest.resize(at(lut.size[0]) * at(lut.size[1]) * at(lut.size[2]));
    const auto most = static_cast<unsigned>(std::max(lut.size[1], lut.size[2]));
    const unsigned bits = std::max(6U, static_cast<unsigned>(std::bit_width(most - 1)));
    std::uint64_t furthest = 0;  // squared
    for (const int n : lut.size) furthest += at(n - 1) * at(n - 1);
    if (furthest >> (32 - bits) == 0)
        transform<std::uint32_t>(lut, rows, bits, path);
    else
        transform<std::uint64_t>(lut, rows, bits, path);
}

}  // namespace planlight
