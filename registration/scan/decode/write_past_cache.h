#pragma once

#include <cstddef>
#include <cstring>

#ifdef __SSE2__
#include <xmmintrin.h>
#endif

#include "planning_io/types/processor_clones.h"

namespace planlight {

/// Writes a vector of floats without fetching what stood there, which takes half of the time where the memory is slow,
/// and without putting out of the caches what is needed soon. `to`, aligned to 16 bytes, is read after
/// `finish_writing`.
template <class Floats>
PLANLIGHT_INLINE void write_past_cache(const Floats& values, float* to) {
#ifdef __SSE2__
    __m128 parts[sizeof values / sizeof(__m128)];
    std::memcpy(parts, &values, sizeof values);
    for (std::size_t i = 0; i < sizeof values / sizeof(__m128); ++i) _mm_stream_ps(to + 4 * i, parts[i]);
#else
    std::memcpy(to, &values, sizeof values);
#endif
}

/// Writes a value n times in the same way; `to` aligned to 16 bytes.
PLANLIGHT_INLINE void fill_past_cache(float value, float* to, std::size_t n) {
    std::size_t i = 0;
#ifdef __SSE2__
    const __m128 four = _mm_set1_ps(value);
    for (; i + 4 <= n; i += 4) _mm_stream_ps(to + i, four);
#endif
    for (; i < n; ++i) to[i] = value;
}

/// Makes what was written past the caches visible to other threads.
PLANLIGHT_INLINE void finish_writing() {
#ifdef __SSE2__
    _mm_sfence();
#endif
}

}  // namespace planlight
