#include "app/freed_memory.h"

#include <malloc.h>

namespace planlight {

void keep_freed_memory() {
    constexpr int kMmapFrom_bytes = 32 << 20;  // the most that the library takes
    constexpr int kKept_bytes = 1 << 30;
    mallopt(M_MMAP_THRESHOLD, kMmapFrom_bytes);
    mallopt(M_TRIM_THRESHOLD, kKept_bytes);
    mallopt(M_TOP_PAD, 16 << 20);
}

void hand_large_blocks_back() {
    constexpr int kLarge_bytes = 256 << 10;  // less than the picture of a camera
    mallopt(M_MMAP_THRESHOLD, kLarge_bytes);
}

}  // namespace planlight
