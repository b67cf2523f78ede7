#include "registration/scan/decode/decode_gray_pairs.h"

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>

#include "registration/scan/decode/decode_blocks.h"
#include "registration/scan/decode/gray_pair_kernel.h"

namespace planlight {
namespace {

namespace kernels = decode_kernels;

struct Block {
    alignas(64) std::array<std::uint16_t, kernels::kBlock> columns, rows;
    alignas(64) std::array<std::uint8_t, kernels::kBlock> limit;
    alignas(64) kernels::CodeBytes code;
};

void check_sizes(const GrayPairs& frames) {
    const auto same = [&](const GrayImage& f) {
        return f.width == frames.white.width && f.height == frames.white.height &&
               f.pixels.size() == frames.white.pixels.size();
    };
    if (!same(frames.black) || !std::all_of(frames.columns.begin(), frames.columns.end(), same) ||
        !std::all_of(frames.rows.begin(), frames.rows.end(), same))
        throw std::invalid_argument("decode_gray_pairs: frames of different size");
    if (frames.columns.size() > 32 || frames.rows.size() > 32)
        throw std::invalid_argument("decode_gray_pairs: more than 16 bits");
    if (frames.columns.size() % 2 != 0 || frames.rows.size() % 2 != 0)
        throw std::invalid_argument("decode_gray_pairs: a bit without its inverse");
    if (std::max(frames.projector_width, frames.projector_height) > gray_pair_kernel::kMostPixels)
        throw std::invalid_argument("decode_gray_pairs: a projector of more than 32767 pixels");
}

/// Of a block: the bits of the columns, their inverses, the bits of the rows, their inverses.
class BlockFrames {
public:
    BlockFrames(const GrayPairs& pairs, std::size_t begin) {
        for (const std::span<const GrayImage>& direction : {pairs.columns, pairs.rows})
            for (std::size_t inverse : {0, 1})
                for (std::size_t k = inverse; k < direction.size(); k += 2)
                    frames_[count_++] = direction[k].pixels.data() + begin;
    }
    const std::uint8_t* const* data() const { return frames_.data(); }
    std::size_t size() const { return count_; }

private:
    std::array<const std::uint8_t*, 4 * kernels::kMostBits> frames_;
    std::size_t count_ = 0;
};

/// The pictures of one direction: `data`, as many bits as pairs, then their inverses.
struct Direction {
    const std::uint8_t* const* data;
    int pairs, size;

    void decide_coarse(std::size_t n, Block& b) const {
        kernels::decide_bits(data, data + pairs, nullptr, b.limit.data(), coarse(), b.code.high, b.code.doubt_high, n);
    }
    void decide_fine(std::size_t n, Block& b) const {
        kernels::decide_bits(data + coarse(), data + pairs + coarse(), nullptr, b.limit.data(), pairs - coarse(),
                             b.code.low, b.code.doubt_low, n);
    }
    int coarse() const { return kernels::coarse_bits(pairs); }
};

kernels::Counts decode_block(const GrayPairs& frames, const GrayLimits& limits, std::size_t begin, std::size_t n,
                             Block& b, DecodedView& view) {
    const std::uint8_t *white = frames.white.pixels.data() + begin, *black = frames.black.pixels.data() + begin;
    kernels::expect_next(white, kernels::kFarAhead);
    kernels::expect_next(black, kernels::kFarAhead);
    float *column = view.column.data() + begin, *row = view.row.data() + begin, *sigma = view.sigma_px.data() + begin;
    if (kernels::highest_contrast(white, black, n) < limits.least_grey)
        return kernels::keep_none(white, limits.saturated_at, column, row, sigma, n);
    // In doubt is what lies below the limit: one grey less than the least that is believed.
    kernels::doubt_below_contrast(white, black, static_cast<float>(limits.least_share),
                                  static_cast<float>(limits.least_grey), b.limit.data(), n);
    const BlockFrames all(frames, begin);
    kernels::LinesAhead ahead(all.data(), all.size());
    const Direction columns{all.data(), static_cast<int>(frames.columns.size() / 2), frames.projector_width};
    const Direction rows{all.data() + frames.columns.size(), static_cast<int>(frames.rows.size() / 2),
                         frames.projector_height};
    const gray_pair_kernel::Limits known{limits.least_grey, limits.saturated_at};
    columns.decide_coarse(n, b);
    if (columns.coarse() >= 2 && !gray_pair_kernel::any_left(white, black, b.code.doubt_high, known, n)) {
        b.columns.fill(gray_pair_kernel::kUnknown);
        b.rows.fill(gray_pair_kernel::kUnknown);
    } else {
        columns.decide_fine(n, b);
        gray_pair_kernel::find_halves(b.code, columns.size, b.columns.data(), n, ahead);
        rows.decide_coarse(n, b);
        rows.decide_fine(n, b);
        gray_pair_kernel::find_halves(b.code, rows.size, b.rows.data(), n, ahead);
    }
    constexpr float kSigma_px = 0.29f;
    return gray_pair_kernel::keep_pairs(b.columns.data(), b.rows.data(), white, black, known, kSigma_px, column, row,
                                        sigma, n, ahead);
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
