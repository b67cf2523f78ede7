// The passes for processors with AVX-512 (F, BW, DQ, VL); compiled with that set's flags.
#include "segmentation/nearest_passes_kernel.h"

namespace planlight::nearest_passes {

const Passes<std::uint32_t> kAvx512{in_slice<std::uint32_t>, across_slices<std::uint32_t>};
const Passes<std::uint64_t> kAvx512Wide{in_slice<std::uint64_t>, across_slices<std::uint64_t>};

}  // namespace planlight::nearest_passes
