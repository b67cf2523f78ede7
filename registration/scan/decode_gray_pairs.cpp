#include "registration/scan/decode_gray_pairs.h"

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>

#include "registration/scan/decode_blocks.h"

namespace planlight {
namespace {

namespace kernels = decode_kernels;

struct Block {
    alignas(64) std::array<float, kernels::kBlock> contrast, column, row;
    alignas(64) std::array<std::uint8_t, kernels::kBlock> limit;
    alignas(64) kernels::CodeBytes code;
};

void check_sizes(const GrayPairs& frames) {
    const auto same = [&](const GrayImage& f) {
        return f.width == frames.white.width && f.height == frames.white.height && f.pixels.size() == frames.white.pixels.size();
    };
    if (!same(frames.black) || !std::all_of(frames.columns.begin(), frames.columns.end(), same) ||
        !std::all_of(frames.rows.begin(), frames.rows.end(), same))
        throw std::invalid_argument("decode_gray_pairs: frames of different size");
    if (frames.columns.size() > 32 || frames.rows.size() > 32)
        throw std::invalid_argument("decode_gray_pairs: more than 16 bits");
}

void decode_direction(std::span<const GrayImage> pairs, int size, std::size_t begin, std::size_t n, Block& b,
                      float* pixel) {
    const std::size_t count = pairs.size() / 2;
    std::array<const std::uint8_t*, kernels::kMostBits> bits, inverses;
    for (std::size_t k = 0; k < count; ++k) {
        bits[k] = pairs[2 * k].pixels.data() + begin;
        inverses[k] = pairs[2 * k + 1].pixels.data() + begin;
    }
    kernels::decide_bits(bits.data(), inverses.data(), nullptr, b.limit.data(), static_cast<int>(count), b.code, n);
    kernels::place_code(b.code, 1, static_cast<float>(size), pixel, n);
}

kernels::Counts decode_block(const GrayPairs& frames, const GrayLimits& limits, std::size_t begin, std::size_t n, Block& b,
                             DecodedView& view) {
    const std::uint8_t *white = frames.white.pixels.data() + begin, *black = frames.black.pixels.data() + begin;
    kernels::expect_next(white, kernels::kFarAhead);
    kernels::expect_next(black, kernels::kFarAhead);
    float *column = view.column.data() + begin, *row = view.row.data() + begin, *sigma = view.sigma_px.data() + begin;
    if (kernels::highest_contrast(white, black, n) < limits.least_grey)
        return kernels::keep_none(white, limits.saturated_at, column, row, sigma, n);
    // In doubt is what lies below the limit: one grey less than the least that is believed.
    kernels::doubt_below_contrast(white, black, static_cast<float>(limits.least_share), static_cast<float>(limits.least_grey),
                                  b.limit.data(), n);
    decode_direction(frames.columns, frames.projector_width, begin, n, b, b.column.data());
    decode_direction(frames.rows, frames.projector_height, begin, n, b, b.row.data());
    kernels::contrast_of(white, black, b.contrast.data(), n);
    const kernels::DirectionBlock columns{b.contrast.data(), b.column.data(), white},
        rows{b.contrast.data(), b.row.data(), white};
    const kernels::Limits good{static_cast<float>(limits.least_grey), 0, 0, 1, limits.saturated_at};
    const kernels::Counts counts = kernels::keep_good(columns, &rows, white, black, good, column, row, sigma, n);
    kernels::set_where_known(column, 0.29f, sigma, n);
    return counts;
}

}  // namespace

DecodedView decode_gray_pairs(const GrayPairs& frames, const GrayLimits& limits) {
    check_sizes(frames);
    DecodedView view = empty_view(frames.white.width, frames.white.height, true);
    decode_by_blocks<Block>(view, [&](std::size_t begin, std::size_t n, Block& block) {
        return decode_block(frames, limits, begin, n, block, view);
    });
    return view;
}

}  // namespace planlight
