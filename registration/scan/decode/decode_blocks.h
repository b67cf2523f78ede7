#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <memory>

#include "registration/scan/decode/decode_kernels.h"
#include "registration/scan/decode/decode_stripes.h"

// What the decoders have in common: blocks of pixels in parallel, counts summed. Private to registration/scan.
namespace planlight {

/// A view of this size whose values are still to be written, all of them.
inline DecodedView empty_view(int width, int height, bool rows) {
    DecodedView view;
    view.width = width;
    view.height = height;
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    view.column.resize(pixels);
    if (rows) view.row.resize(pixels);
    view.sigma_px.resize(pixels);
    return view;
}

/// Calls `decode(begin, n, work)` for the pixels [begin, begin + n) of all blocks, with working arrays of each thread's
/// own, and sets the counts of the view.
template <class Work, class Decode>
void decode_by_blocks(DecodedView& view, const Decode& decode) {
    using decode_kernels::kBlock;
    const std::size_t pixels = view.column.size(), blocks = (pixels + kBlock - 1) / kBlock;
    std::atomic<std::size_t> decoded{0}, dark{0}, saturated{0}, uncertain{0};
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks, 32),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          const auto work = std::make_unique_for_overwrite<Work>();
                          for (std::size_t block = range.begin(); block < range.end(); ++block) {
                              const std::size_t begin = block * kBlock, n = std::min(kBlock, pixels - begin);
                              const decode_kernels::Counts counts = decode(begin, n, *work);
                              decoded += counts.decoded;
                              dark += counts.dark;
                              saturated += counts.saturated;
                              uncertain += counts.uncertain;
                          }
                      });
    view.decoded = decoded;
    view.dark = dark;
    view.saturated = saturated;
    view.uncertain = uncertain;
}

}  // namespace planlight
