// The two passes, compiled once for each set of instructions by nearest_passes_*.cpp. Everything here has internal
// linkage and nothing of the standard library is called, so that no code of one set can end up in another.
#pragma once

#if defined(__AVX2__)
#include <immintrin.h>
#endif

#include "segmentation/nearest_passes.h"

namespace planlight::nearest_passes {
namespace {

#if defined(__AVX512F__)
constexpr int kVectorBytes = 64;
#elif defined(__AVX2__)
constexpr int kVectorBytes = 32;
#else
constexpr int kVectorBytes = 16;
#endif

#define PLANLIGHT_INLINE inline __attribute__((always_inline))

template <class Key>
struct Lanes {
    typedef Key Vector __attribute__((vector_size(kVectorBytes)));
    typedef Key Unaligned __attribute__((vector_size(kVectorBytes), aligned(sizeof(Key)), may_alias));
    static constexpr int kWidth = kVectorBytes / static_cast<int>(sizeof(Key));
    static constexpr int kCount = kLanes / kWidth;
    Vector v[kCount];

    PLANLIGHT_INLINE void load(const Key* from) {
        for (int i = 0; i < kCount; ++i) v[i] = *reinterpret_cast<const Unaligned*>(from + i * kWidth);
    }
    PLANLIGHT_INLINE void store(Key* to) const {
        for (int i = 0; i < kCount; ++i) *reinterpret_cast<Unaligned*>(to + i * kWidth) = v[i];
    }
    /// Keeps the lesser of its own and `other + more`, lane by lane.
    PLANLIGHT_INLINE void keep_least(const Lanes& other, Key more) {
        for (int i = 0; i < kCount; ++i) {
            const Vector candidate = other.v[i] + more;
            v[i] = candidate < v[i] ? candidate : v[i];
        }
    }
};

struct Range {
    int low, high;
};

constexpr int kMostBlends = 8;  // above it single loads are faster

#if defined(__AVX512F__)
PLANLIGHT_INLINE Lanes<std::uint32_t>::Vector gathered(const Lanes<std::uint32_t>::Vector& number,
                                                       const std::uint32_t* entries) {
    static_assert(kLanes == 32);
    const __m512i lane = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    const __m512i at = _mm512_or_si512(_mm512_slli_epi32((__m512i)number, 5), lane);
    return (Lanes<std::uint32_t>::Vector)_mm512_i32gather_epi32(at, entries, 4);
}
#endif

/// Least and greatest number in the lowest bits of the keys.
template <class Key>
PLANLIGHT_INLINE Range range_of(const Lanes<Key>& keys, Key mask) {
#if defined(__AVX512F__)
    if constexpr (sizeof(Key) == 4) {
        const __m512i m = _mm512_set1_epi32(static_cast<int>(mask));
        const __m512i w =
            _mm512_packus_epi32(_mm512_and_si512((__m512i)keys.v[0], m), _mm512_and_si512((__m512i)keys.v[1], m));
        const __m512i inverse = _mm512_xor_si512(w, _mm512_set1_epi32(-1));
        const __m256i a = _mm256_min_epu16(_mm512_castsi512_si256(w), _mm512_extracti64x4_epi64(w, 1));
        const __m256i b = _mm256_min_epu16(_mm512_castsi512_si256(inverse), _mm512_extracti64x4_epi64(inverse, 1));
        const __m128i low = _mm_minpos_epu16(_mm_min_epu16(_mm256_castsi256_si128(a), _mm256_extracti128_si256(a, 1)));
        const __m128i high = _mm_minpos_epu16(_mm_min_epu16(_mm256_castsi256_si128(b), _mm256_extracti128_si256(b, 1)));
        return {_mm_cvtsi128_si32(low) & 0xFFFF, 0xFFFF ^ (_mm_cvtsi128_si32(high) & 0xFFFF)};
    }
#elif defined(__AVX2__)
    if constexpr (sizeof(Key) == 4) {
        const __m256i m = _mm256_set1_epi32(static_cast<int>(mask));
        const __m256i w0 =
            _mm256_packus_epi32(_mm256_and_si256((__m256i)keys.v[0], m), _mm256_and_si256((__m256i)keys.v[1], m));
        const __m256i w1 =
            _mm256_packus_epi32(_mm256_and_si256((__m256i)keys.v[2], m), _mm256_and_si256((__m256i)keys.v[3], m));
        const __m256i a = _mm256_min_epu16(w0, w1),
                      b = _mm256_xor_si256(_mm256_max_epu16(w0, w1), _mm256_set1_epi32(-1));
        const __m128i low = _mm_minpos_epu16(_mm_min_epu16(_mm256_castsi256_si128(a), _mm256_extracti128_si256(a, 1)));
        const __m128i high = _mm_minpos_epu16(_mm_min_epu16(_mm256_castsi256_si128(b), _mm256_extracti128_si256(b, 1)));
        return {_mm_cvtsi128_si32(low) & 0xFFFF, 0xFFFF ^ (_mm_cvtsi128_si32(high) & 0xFFFF)};
    }
#endif
    Range range{0x7FFFFFFF, 0};
    for (int i = 0; i < Lanes<Key>::kCount; ++i)
        for (int l = 0; l < Lanes<Key>::kWidth; ++l) {
            const int number = static_cast<int>(keys.v[i][l] & mask);
            range.low = number < range.low ? number : range.low;
            range.high = number > range.high ? number : range.high;
        }
    return range;
}

/// For every q = 0 .. n-1 and in every lane the least keys[c] + (q - place[c])^2 over the `count` candidates, handed to
/// `put(q, least, range of the candidates)`.
///
/// The first best candidate never falls when q grows (each parabola has the same width), so what was found at two
/// positions bounds the search between them: divide and conquer, n log n.
template <class Key, class Put>
PLANLIGHT_INLINE void least_along_line(const Stripe<Key>& stripe, const Key* keys, const int* place, int count, int n,
                                       int* low, int* high, Put&& put) {
    const Key mask = (Key{1} << stripe.bits) - 1;
    int step = 1;
    while (2 * step <= n) step *= 2;
    low[0] = 0;
    for (; step >= 1; step /= 2)
        for (int t = step; t <= n; t += 2 * step) {  // t = q + 1
            const int first = low[t - step], last = t + step <= n ? high[t + step] : count - 1;
            const Key* square = stripe.squares + (t - 1);
            Lanes<Key> best, candidate;
            best.load(keys + first * kLanes);
            {
                const Key more = square[-place[first]];
                for (int i = 0; i < Lanes<Key>::kCount; ++i) best.v[i] += more;
            }
            for (int c = first + 1; c <= last; ++c) {
                candidate.load(keys + c * kLanes);
                best.keep_least(candidate, square[-place[c]]);
            }
            const Range range = first == last ? Range{first, last} : range_of<Key>(best, mask);
            low[t] = range.low;
            high[t] = range.high;
            put(t - 1, best, range);
        }
}

/// The entry of each lane's candidate: entries[c][lane], c in the lowest bits of the lane's key.
template <class Key>
PLANLIGHT_INLINE void entries_of(const Lanes<Key>& keys, Key mask, Range range, const std::uint32_t* entries,
                                 std::uint32_t* to) {
    if constexpr (sizeof(Key) == 4) {
        Lanes<Key> found;
        found.load(entries + range.low * kLanes);
        if (range.high - range.low <= kMostBlends) {
            Lanes<Key> candidate;
            for (int c = range.low + 1; c <= range.high; ++c) {
                candidate.load(entries + c * kLanes);
                for (int i = 0; i < Lanes<Key>::kCount; ++i)
                    found.v[i] = (keys.v[i] & mask) >= static_cast<Key>(c) ? candidate.v[i] : found.v[i];
            }
        } else {
#if defined(__AVX512F__)
            for (int i = 0; i < Lanes<Key>::kCount; ++i)
                found.v[i] = gathered(keys.v[i] & mask, entries + i * Lanes<Key>::kWidth);
#else
            for (int i = 0; i < Lanes<Key>::kCount; ++i)
                for (int l = 0; l < Lanes<Key>::kWidth; ++l)
                    found.v[i][l] =
                        entries[(keys.v[i][l] & mask) * kLanes + static_cast<std::size_t>(i * Lanes<Key>::kWidth + l)];
#endif
        }
        found.store(to);
    } else {
        for (int i = 0; i < Lanes<Key>::kCount; ++i)
            for (int l = 0; l < Lanes<Key>::kWidth; ++l, ++to, ++entries) *to = entries[(keys.v[i][l] & mask) * kLanes];
    }
}

/// First skin voxel of a row, from `begin`, whose column is at least `x`; `end` when there is none.
PLANLIGHT_INLINE std::uint32_t first_from(const std::uint16_t* skin_x, std::uint32_t begin, std::uint32_t end, int x) {
    while (begin < end) {
        const std::uint32_t middle = begin + (end - begin) / 2;
        if (skin_x[middle] < x)
            begin = middle + 1;
        else
            end = middle;
    }
    return begin;
}

/// The nearest skin voxel of the same row for each lane: those between the lanes, and one beyond on each side.
template <class Key>
PLANLIGHT_INLINE void along_row(const Stripe<Key>& stripe, std::uint32_t begin, std::uint32_t end, int row_number,
                                Key* keys, std::uint32_t* skin) {
    const Key mask = (Key{1} << stripe.bits) - 1;
    std::uint32_t first = first_from(stripe.skin_x, begin, end, stripe.x0);
    std::uint32_t last = first_from(stripe.skin_x, first, end, stripe.x0 + kLanes);
    if (first > begin) --first;
    if (last == end) --last;
    Lanes<Key> best, candidate;
    best.load(stripe.squares + (stripe.x0 - stripe.skin_x[first]));
    for (std::uint32_t s = first + 1; s <= last; ++s) {
        candidate.load(stripe.squares + (stripe.x0 - stripe.skin_x[s]));
        best.keep_least(candidate, s - first);
    }
    for (int i = 0; i < Lanes<Key>::kCount; ++i) {
        const auto number = best.v[i] & mask;
        *reinterpret_cast<typename Lanes<Key>::Unaligned*>(keys + i * Lanes<Key>::kWidth) =
            (best.v[i] - number) | static_cast<Key>(row_number);
        for (int l = 0; l < Lanes<Key>::kWidth; ++l)
            skin[i * Lanes<Key>::kWidth + l] = first + static_cast<std::uint32_t>(number[l]);
    }
}

template <class Key>
void in_slice(const Stripe<Key>& stripe, int slice, void* scratch) {
    const Key mask = (Key{1} << stripe.bits) - 1;
    auto* keys = static_cast<Key*>(scratch);
    auto* skin = reinterpret_cast<std::uint32_t*>(keys + static_cast<std::size_t>(stripe.size_y + 2) * kLanes);
    auto* place = reinterpret_cast<int*>(skin + static_cast<std::size_t>(stripe.size_y + 2) * kLanes);
    int *low = place + stripe.size_y + 2, *high = low + stripe.size_y + 2;
    const std::uint32_t* row_begin =
        stripe.row_begin + static_cast<std::size_t>(stripe.slices[slice]) * static_cast<std::size_t>(stripe.size_y);
    int rows = 0;
    for (int y = 0; y < stripe.size_y; ++y) {
        if (row_begin[y] == row_begin[y + 1]) continue;
        place[rows] = y;
        along_row(stripe, row_begin[y], row_begin[y + 1], rows, keys + rows * kLanes, skin + rows * kLanes);
        ++rows;
    }
    least_along_line(
        stripe, keys, place, rows, stripe.size_y, low, high, [&](int y, const Lanes<Key>& best, Range range) {
            const std::size_t at =
                static_cast<std::size_t>(y) * stripe.row_step + static_cast<std::size_t>(slice) * kLanes;
            for (int i = 0; i < Lanes<Key>::kCount; ++i)
                *reinterpret_cast<typename Lanes<Key>::Unaligned*>(stripe.keys + at + i * Lanes<Key>::kWidth) =
                    (best.v[i] & ~mask) | static_cast<Key>(slice);
            entries_of(best, mask, range, skin, stripe.skin + at);
        });
}

template <class Key>
void across_slices(const Stripe<Key>& stripe, int y, void* scratch) {
    const Key mask = (Key{1} << stripe.bits) - 1;
    auto* low = static_cast<int*>(scratch);
    int* high = low + stripe.size_z + 2;
    const std::size_t column = static_cast<std::size_t>(y) * stripe.row_step;
    const Key* keys = stripe.keys + column;
    const std::uint32_t* skin = stripe.skin + column;
    const int lanes = stripe.size_x - stripe.x0 < kLanes ? stripe.size_x - stripe.x0 : kLanes;
    least_along_line(stripe, keys, stripe.slices, stripe.slice_count, stripe.size_z, low, high,
                     [&](int z, const Lanes<Key>& best, Range range) {
                         std::uint32_t* to = stripe.nearest +
                                             (static_cast<std::size_t>(z) * static_cast<std::size_t>(stripe.size_y) +
                                              static_cast<std::size_t>(y)) *
                                                 static_cast<std::size_t>(stripe.size_x) +
                                             static_cast<std::size_t>(stripe.x0);
                         if (lanes == kLanes) {
                             entries_of(best, mask, range, skin, to);
                         } else {
                             alignas(64) std::uint32_t part[kLanes];
                             entries_of(best, mask, range, skin, part);
                             __builtin_memcpy(to, part, static_cast<std::size_t>(lanes) * sizeof(std::uint32_t));
                         }
                     });
}

}  // namespace
}  // namespace planlight::nearest_passes
