#include "registration/scan/gray_code.h"

#include <fmt/format.h>

#include <stdexcept>

#include "registration/scan/decode_gray_pairs.h"

namespace planlight {
namespace {

int bits_for(int size) {
    int bits = 1;
    while ((1 << bits) < size) ++bits;
    return bits;
}

}  // namespace

std::vector<StripePattern> gray_code_patterns(int projector_width, int projector_height) {
    using Kind = StripePattern::Kind;
    std::vector<StripePattern> patterns{{Kind::white, false, 0, "white"}, {Kind::black, false, 0, "black"}};
    for (const bool along_rows : {false, true})
        for (int bit = 0; bit < bits_for(along_rows ? projector_height : projector_width); ++bit) {
            const std::string name = fmt::format("{}-gray-{}", along_rows ? "row" : "column", bit);
            patterns.push_back({Kind::gray_bit, along_rows, bit, name});
            patterns.push_back({Kind::gray_bit_inverse, along_rows, bit, name + "-inverse"});
        }
    return patterns;
}

std::vector<std::string> gray_code_names(int projector_width, int projector_height) {
    std::vector<std::string> names;
    for (const StripePattern& pattern : gray_code_patterns(projector_width, projector_height)) names.push_back(pattern.name);
    return names;
}

DecodedView decode_gray_code(std::span<const GrayImage> frames, int projector_width, int projector_height) {
    const int column_bits = bits_for(projector_width), row_bits = bits_for(projector_height);
    if (frames.size() != static_cast<std::size_t>(2 + 2 * column_bits + 2 * row_bits))
        throw std::invalid_argument(
            fmt::format("decode_gray_code: {} frames, {} are needed", frames.size(), 2 + 2 * column_bits + 2 * row_bits));
    const auto column_frames = static_cast<std::size_t>(2 * column_bits);
    return decode_gray_pairs({frames[0], frames[1], frames.subspan(2, column_frames), frames.subspan(2 + column_frames),
                              projector_width, projector_height});
}

}  // namespace planlight
