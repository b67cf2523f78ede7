#include "planning_io/types/large_array.h"

#include <sys/mman.h>

#include <cstdlib>
#include <new>

namespace planlight {
namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20;
constexpr std::size_t kCacheLine = 64;

std::size_t rounded_up(std::size_t bytes, std::size_t unit) { return (bytes + unit - 1) / unit * unit; }

}  // namespace

void* allocate_large(std::size_t bytes) {
    const std::size_t unit = bytes < 2 * kHugePage ? kCacheLine : kHugePage;
    void* memory = std::aligned_alloc(unit, rounded_up(bytes, unit));
    if (!memory) throw std::bad_alloc();
    if (unit == kHugePage) madvise(memory, rounded_up(bytes, unit), MADV_HUGEPAGE);  // a wish: without it all works, slower
    return memory;
}

void free_large(void* memory, std::size_t) noexcept { std::free(memory); }

}  // namespace planlight
