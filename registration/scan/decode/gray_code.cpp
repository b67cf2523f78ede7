#include "registration/scan/decode/gray_code.h"

#include <fmt/format.h>

#include <limits>
#include <stdexcept>
#include <utility>

#include "registration/scan/decode/decode_gray_pairs.h"

namespace planlight {
namespace {

int bits_for(int size) {
    int bits = 1;
    while ((1 << bits) < size) ++bits;
    return bits;
}

}  // namespace

std::vector<StripePattern> gray_code_patterns(const StripeSettings& stripes) {
    using Kind = StripePattern::Kind;
    std::vector<StripePattern> patterns{{Kind::white, false, 0, "white"}, {Kind::black, false, 0, "black"}};
    for (const bool along_rows : {false, true}) {
        if (along_rows && !stripes.rows) continue;
        const int bits =
            bits_for(along_rows ? stripes.begins_at_row + stripes.height : stripes.begins_at_column + stripes.width);
        for (StripePattern& pattern : gray_patterns(bits, along_rows, stripes.inverse))
            patterns.push_back(std::move(pattern));
    }
    return patterns;
}

namespace {

/// From the code's numbers to the projector's pixels; NaN for what lies before the first.
void count_from(int begins_at, LargeArray<float>& code) {
    if (begins_at == 0) return;
    for (float& c : code) {
        c -= static_cast<float>(begins_at);
        if (c < -0.5F) c = std::numeric_limits<float>::quiet_NaN();
    }
}

}  // namespace

DecodedView decode_gray_code(std::span<const GrayImage> frames, const StripeSettings& stripes) {
    const int columns = stripes.begins_at_column + stripes.width, rows = stripes.begins_at_row + stripes.height;
    const int column_bits = bits_for(columns), row_bits = bits_for(rows);
    if (frames.size() != static_cast<std::size_t>(2 + 2 * column_bits + 2 * row_bits))
        throw std::invalid_argument(fmt::format("decode_gray_code: {} frames, {} are needed", frames.size(),
                                                2 + 2 * column_bits + 2 * row_bits));
    const auto column_frames = static_cast<std::size_t>(2 * column_bits);
    DecodedView view = decode_gray_pairs(
        {frames[0], frames[1], frames.subspan(2, column_frames), frames.subspan(2 + column_frames), columns, rows});
    count_from(stripes.begins_at_column, view.column);
    count_from(stripes.begins_at_row, view.row);
    return view;
}

DecodedView decode_gray_code(std::span<const GrayImage> frames, int projector_width, int projector_height) {
    StripeSettings stripes;
    stripes.width = projector_width;
    stripes.height = projector_height;
    return decode_gray_code(frames, stripes);
}

}  // namespace planlight
