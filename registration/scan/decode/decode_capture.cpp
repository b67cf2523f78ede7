#include "registration/scan/decode/decode_capture.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "registration/scan/decode/gray_cells.h"

namespace planlight {
namespace {

using Kind = StripePattern::Kind;

/// One camera's pictures by what they are. A cell of the finest Gray bit is half a period.
GrayFrames sort_gray(const std::vector<GrayImage>& frames, const std::vector<StripePattern>& patterns,
                     const StripeSettings& s) {
    if (frames.size() != patterns.size())
        throw std::invalid_argument("decode_capture: the pictures are not as many as their patterns");
    GrayFrames sorted;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        GrayDirection& direction = patterns[i].along_rows ? sorted.rows : sorted.columns;
        if (patterns[i].kind == Kind::white) sorted.white = &frames[i];
        if (patterns[i].kind == Kind::black) sorted.black = &frames[i];
        if (patterns[i].kind == Kind::gray_bit) direction.bits.push_back(&frames[i]);
        if (patterns[i].kind == Kind::gray_bit_inverse) direction.inverses.push_back(&frames[i]);
    }
    const auto finish = [&](GrayDirection& direction, int size, bool along_rows) {
        direction.size = size;
        direction.begins_at = along_rows ? s.begins_at_row : s.begins_at_column;
        const int missing = gray_bits(s, along_rows) - static_cast<int>(direction.bits.size());
        direction.cell_px = std::ldexp(s.phase_period_px / 2, std::max(0, missing));
    };
    finish(sorted.columns, s.width, false);
    finish(sorted.rows, s.height, true);
    return sorted;
}

GrayCells gray_of(const std::vector<GrayImage>& frames, const ScanCapture& capture, const DecodeSettings& settings) {
    GrayCellSettings cells;
    cells.saturated_at = settings.saturated_at;
    const auto& patterns = capture.partial.empty() ? stripe_sequence(capture.stripes) : capture.partial;
    return decode_gray_cells(sort_gray(frames, patterns, capture.stripes), cells);
}

DecodedCapture by_gray(const ScanCapture& capture, bool right, const DecodeSettings& settings) {
    GrayCells left_cells = gray_of(capture.left, capture, settings);
    DecodedCapture decoded{std::move(left_cells.view), std::nullopt, left_cells.step_px};
    if (!right) return decoded;
    GrayCells right_cells = gray_of(capture.right, capture, settings);
    decoded.right = std::move(right_cells.view);
    decoded.step_px = std::max(decoded.step_px, right_cells.step_px);
    return decoded;
}

/// Lit pixels: white is brighter than black by more than noise.
std::size_t lit_pixels(const GrayImage& white, const GrayImage& black) {
    constexpr int kLeast_grey = 10;
    std::size_t lit = 0;
    for (std::size_t i = 0; i < white.pixels.size(); ++i) lit += white.pixels[i] > black.pixels[i] + kLeast_grey;
    return lit;
}

}  // namespace

DecodedCapture decode_capture(const ScanCapture& capture, bool with_right, const DecodeSettings& settings) {
    const bool right = with_right && !capture.right.empty();
    if (!capture.partial.empty()) return by_gray(capture, right, settings);
    DecodedCapture decoded;
    tbb::parallel_invoke([&] { decoded.left = decode_stripes(capture.left, capture.stripes, settings); },
                         [&] {
                             if (right) decoded.right = decode_stripes(capture.right, capture.stripes, settings);
                         });
    constexpr double kLeastDecoded = 0.02;
    const bool gray_code = capture.stripes.order_periods_px.empty();
    const auto enough_of = [&](std::size_t pixels) {
        return static_cast<double>(decoded.left.decoded) >= kLeastDecoded * static_cast<double>(pixels);
    };
    // Of all pixels is more than of the lit ones, and they need not be counted.
    if (!gray_code || enough_of(decoded.left.column.size())) return decoded;
    if (enough_of(lit_pixels(capture.left[0], capture.left[1]))) return decoded;
    DecodedCapture coarse = by_gray(capture, right, settings);
    return coarse.left.decoded > 10 * (decoded.left.decoded + 100) ? coarse : decoded;
}

}  // namespace planlight
