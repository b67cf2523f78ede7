#include "registration/scan/decode/gray_pair_kernel.h"

#include <cstring>
#include <limits>

#include "planning_io/types/processor_clones.h"
#include "registration/scan/decode/write_past_cache.h"

namespace planlight::gray_pair_kernel {

using decode_kernels::Counts;

namespace {

typedef std::uint8_t HalfBytes __attribute__((vector_size(16)));
typedef std::uint16_t Words __attribute__((vector_size(32)));
constexpr std::size_t kLanes = sizeof(Words) / sizeof(std::uint16_t);

PLANLIGHT_INLINE void load_words(const std::uint8_t* low, const std::uint8_t* high, Words& words) {
    HalfBytes l, h;
    std::memcpy(&l, low, sizeof l);
    std::memcpy(&h, high, sizeof h);
    words = __builtin_convertvector(l, Words) | __builtin_convertvector(h, Words) << 8;
}

typedef std::int16_t Numbers __attribute__((vector_size(32)));
typedef float Floats __attribute__((vector_size(64)));
typedef std::int32_t Masks __attribute__((vector_size(64)));

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// The halves by `scale`, and `offset` more, where they are known; NaN elsewhere.
PLANLIGHT_INLINE void write_pixels(const Words& halves, float scale, float offset, float* to) {
    const Masks whole = __builtin_convertvector(halves, Masks);
    const Floats pixels = __builtin_convertvector(whole, Floats) * scale + offset;
    write_past_cache(whole == kUnknown ? Floats{} + kNaN : pixels, to);
}

PLANLIGHT_INLINE std::uint32_t sum_of(const Numbers& counts) {
    int sum = 0;
    for (std::size_t lane = 0; lane < kLanes; ++lane) sum += counts[lane];
    return static_cast<std::uint32_t>(sum);
}

}  // namespace

PLANLIGHT_CLONES void find_halves(const decode_kernels::CodeBytes& code, int size, std::uint16_t* halves, std::size_t n,
                                  decode_kernels::LinesAhead& ahead) {
    const Words end = Words{} + static_cast<std::uint16_t>(size), unknown = Words{} + kUnknown, one = Words{} + 1,
                none = {};
    for (std::size_t i = 0; i < n; i += kLanes) {
        ahead.ask_for_four();
        Words number, doubt;
        load_words(code.low + i, code.high + i, number);
        load_words(code.doubt_low + i, code.doubt_high + i, doubt);
        number ^= number >> 1;
        number ^= number >> 2;
        number ^= number >> 4;
        number ^= number >> 8;
        // Binary from Gray is linear: a single changed bit changes it and all finer ones.
        const Words less = doubt - one, finer = doubt == 0 ? none : doubt | less, other = number ^ finer;
        const Words high = number > other ? number : other, low = number > other ? other : number;
        const Words one_doubt = (doubt & less) == 0 ? number + other : unknown;
        const Words apart_by_one = high - low <= 1 ? one_doubt : unknown;
        const Words found = high < end ? apart_by_one : unknown;
        std::memcpy(halves + i, &found, sizeof found);
    }
}

PLANLIGHT_CLONES bool any_left(const std::uint8_t* white, const std::uint8_t* black, const std::uint8_t* doubt,
                               const Limits& limits, std::size_t n) {
    const Limits l = limits;
    int left = 0;
    for (std::size_t i = 0; i < n; ++i)
        left |=
            (white[i] - black[i] >= l.least_grey) & (white[i] < l.saturated_at) & ((doubt[i] & (doubt[i] - 1)) == 0);
    return left != 0;
}

PLANLIGHT_CLONES Counts keep_pairs(const std::uint16_t* columns, const std::uint16_t* rows, const std::uint8_t* white,
                                   const std::uint8_t* black, const Limits& limits, float sigma_px, float* column,
                                   float* row, float* sigma, std::size_t n, decode_kernels::LinesAhead& ahead) {
    const Numbers least = Numbers{} + static_cast<std::int16_t>(limits.least_grey);
    const Numbers bright_from = Numbers{} + static_cast<std::int16_t>(limits.saturated_at);
    const Numbers none = {}, one = Numbers{} + 1;
    const Words every_bit = Words{} + kUnknown;
    Numbers decoded = {}, saturated = {}, dark = {};
    std::size_t i = 0;
    for (; i + kLanes <= n; i += kLanes) {
        ahead.ask_for_four();
        HalfBytes w, b;
        Words c, r;
        std::memcpy(&w, white + i, sizeof w);
        std::memcpy(&b, black + i, sizeof b);
        std::memcpy(&c, columns + i, sizeof c);
        std::memcpy(&r, rows + i, sizeof r);
        const Numbers light = __builtin_convertvector(w, Numbers),
                      contrast = light - __builtin_convertvector(b, Numbers);
        const Numbers bright = light >= bright_from ? one : none;
        const Numbers unlit = contrast < least ? one & ~bright : none;
        const Words bad = c == kUnknown ? every_bit : r == kUnknown ? every_bit : (Words) - (bright | unlit);
        c |= bad;
        r |= bad;
        decoded += (Numbers)bad + one;
        saturated += bright;
        dark += unlit;
        write_pixels(c, 0.5f, 0, column + i);
        write_pixels(r, 0.5f, 0, row + i);
        write_pixels(c, 0, sigma_px, sigma + i);
    }
    finish_writing();
    Counts counts{sum_of(decoded), sum_of(dark), sum_of(saturated), 0};
    for (; i < n; ++i) {
        const int bright = white[i] >= limits.saturated_at, unlit = !bright & (white[i] - black[i] < limits.least_grey);
        const bool good = !bright && !unlit && columns[i] != kUnknown && rows[i] != kUnknown;
        column[i] = good ? 0.5f * static_cast<float>(columns[i]) : kNaN;
        row[i] = good ? 0.5f * static_cast<float>(rows[i]) : kNaN;
        sigma[i] = good ? sigma_px : kNaN;
        counts.decoded += good;
        counts.saturated += static_cast<std::uint32_t>(bright);
        counts.dark += static_cast<std::uint32_t>(unlit);
    }
    counts.uncertain = static_cast<std::uint32_t>(n) - counts.decoded - counts.dark - counts.saturated;
    return counts;
}

}  // namespace planlight::gray_pair_kernel
