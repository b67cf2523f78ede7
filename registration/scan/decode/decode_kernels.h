#pragma once

#include <cstddef>
#include <cstdint>

// The inner loops of the decoder: plain arrays of `n` pixels, one call per frame and block of pixels. Compiled for
// AVX-512, AVX2 and any x86-64; the processor's own set is chosen when the program starts.
namespace planlight::decode_kernels {

/// Pixels of one block: its working arrays stay in the first cache level.
inline constexpr std::size_t kBlock = 1024;
inline constexpr std::size_t kMostBits = 16;  ///< of a Gray code

/// A Gray code of up to 16 bits and the bits that are in doubt, as low and high bytes.
struct CodeBytes {
    alignas(64) std::uint8_t low[kBlock], high[kBlock], doubt_low[kBlock], doubt_high[kBlock];
};

/// Asks for the next block of a frame while this one is worked on: the processor by itself does not follow 40 frames at
/// once.
inline void expect_next(const std::uint8_t* frame, std::size_t blocks_ahead = 1) {
    const std::uint8_t* next = frame + blocks_ahead * kBlock;
#pragma GCC unroll 16
    for (std::size_t at = 0; at < kBlock; at += 64) __builtin_prefetch(next + at);
}

/// Lines of the frames' next block, asked for a few at a time while something else is computed: of what it is asked for
/// all at once, by `decide_bits`, the processor forgets a part.
class LinesAhead {
public:
    LinesAhead(const std::uint8_t* const* frames, std::size_t count) : frames_(frames), lines_(count * kLines) {}
    void ask_for_four() {
        if (next_ >= lines_) return;
        const std::uint8_t* line = frames_[next_ / kLines] + kBlock + next_ % kLines * kLine;
        for (std::size_t i = 0; i < 4; ++i) __builtin_prefetch(line + i * kLine);
        next_ += 4;
    }

private:
    static constexpr std::size_t kLine = 64, kLines = kBlock / kLine;
    const std::uint8_t* const* frames_;
    std::size_t lines_, next_ = 0;
};

/// White and black are all that is looked at where there is no light: those blocks follow each other quickly.
inline constexpr std::size_t kFarAhead = 6;

/// The greatest difference of white and black (0 where black is the brighter).
int highest_contrast(const std::uint8_t* white, const std::uint8_t* black, std::size_t n);

/// Adds a fringe frame, weighted by the sine and cosine of its shift; `top` keeps the brightest value.
void add_phase(const std::uint8_t* frame, float sine, float cosine, float* sine_sum, float* cosine_sum,
               std::uint8_t* top, std::size_t n);

/// The same for all of eight frames shifted by an eighth of a period each; the sums and `top` are set, not added to.
void sum_eight_phases(const std::uint8_t* const* frames, float* sine_sum, float* cosine_sum, std::uint8_t* top,
                      std::size_t n);

/// The fringe amplitude (`amplitude_scale` is 2 / steps) and the phase as pixels in [-period/2, period/2].
void finish_phase(const float* sine_sum, const float* cosine_sum, float amplitude_scale, float period, float* amplitude,
                  float* phase_px, std::size_t n);

/// The grey difference below which a Gray bit is in doubt: a part of the fringe amplitude, at least `floor`.
void doubt_below(const float* amplitude, float part, float floor, std::uint8_t* limit, std::size_t n);

/// For a code without fringes: the difference below which, by (white - black) and in grey, a bit is in doubt, less one.
void doubt_below_contrast(const std::uint8_t* white, const std::uint8_t* black, float part, float floor,
                          std::uint8_t* limit, std::size_t n);

/// Decides up to 8 bits, coarsest first, each by its frame against its inverse (`inverses`: one a bit), or all against
/// one other threshold (`inverses` null: `middle`). A difference of `limit` or less is doubt.
void decide_bits(const std::uint8_t* const* frames, const std::uint8_t* const* inverses, const std::uint8_t* middle,
                 const std::uint8_t* limit, int bits, std::uint8_t* code, std::uint8_t* doubt, std::size_t n);

/// How many of a code's bits stand in the upper byte: the coarse ones.
constexpr int coarse_bits(int bits) {
    return bits > 8 ? bits - 8 : 0;
}

/// Halfway between white and black, and half of `limit`: the threshold for a bit without an inverse.
void middle_of(const std::uint8_t* white, const std::uint8_t* black, const std::uint8_t* limit, std::uint8_t* middle,
               std::uint8_t* half_limit, std::size_t n);

/// Joins Gray code and phase to a projector pixel; NaN where they do not determine it. A bit in doubt is harmless
/// where the code with and without it unwraps to the same pixel (its own border); two are not.
void unwrap(const CodeBytes& code, const float* phase_px, float period, float size, float* pixel, std::size_t n);

/// What makes a pixel of one direction believable.
struct Limits {
    float min_modulation, min_direct_fraction, sigma_by_inverse_amplitude, max_sigma_px;
    int saturated_at;
};

/// Pixels by the reason they were dropped for.
struct Counts {
    std::uint32_t decoded = 0, dark = 0, saturated = 0, uncertain = 0;
};

/// One direction of a block as decoded.
struct DirectionBlock {
    const float *amplitude, *pixel;
    const std::uint8_t* top;  ///< the brightest value seen
};

/// Writes column, row (if coded: `rows` and `row` not null) and sigma of the believable pixels, NaN for the rest,
/// counted.
Counts keep_good(const DirectionBlock& columns, const DirectionBlock* rows, const std::uint8_t* white,
                 const std::uint8_t* black, const Limits& limits, float* column, float* row, float* sigma_px,
                 std::size_t n);

/// Whether a pixel of the first direction is neither dark nor saturated.
bool any_lit(const float* amplitude, const std::uint8_t* top, const std::uint8_t* white, const std::uint8_t* black,
             const Limits& limits, std::size_t n);

/// A block without light: all NaN; dark, or saturated where the brightest value is.
Counts keep_none(const std::uint8_t* top, int saturated_at, float* column, float* row, float* sigma_px, std::size_t n);

}  // namespace planlight::decode_kernels
