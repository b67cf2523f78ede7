#include "planning_io/types/large_array.h"

#include <malloc.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <new>
#include <vector>

#include "planning_io/types/spare_memory.h"

namespace planlight {
namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20;
constexpr std::size_t kPage = 4096, kCacheLine = 64;

std::size_t rounded_up(std::size_t bytes, std::size_t unit) {
    return (bytes + unit - 1) / unit * unit;
}

/// Large blocks that were given back, for the next ones of their size: a scan wants the same arrays again and again,
/// and to have 50 MB cleared by the system takes it as long as to decode them.
class Spares {
public:
    void* take(std::size_t bytes) {
        const std::scoped_lock lock(mutex_);
        const auto found =
            std::find_if(blocks_.begin(), blocks_.end(), [&](const Block& b) { return b.bytes == bytes; });
        if (found == blocks_.end()) return nullptr;
        void* memory = found->memory;
        blocks_.erase(found);
        bytes_ -= bytes;
        return memory;
    }
    /// False when there is enough of them.
    bool keep(void* memory, std::size_t bytes) noexcept {
        const std::scoped_lock lock(mutex_);
        if (bytes_ + bytes > kMost || blocks_.size() == blocks_.capacity()) return false;
        blocks_.push_back({memory, bytes});
        bytes_ += bytes;
        return true;
    }

    void release() {
        const std::scoped_lock lock(mutex_);
        for (const Block& block : blocks_) std::free(block.memory);
        blocks_.clear();
        bytes_ = 0;
    }

    /// Never destroyed: arrays may be given back when the program has ended.
    static Spares& all() {
        static Spares* spares = new Spares;
        return *spares;
    }

private:
    struct Block {
        void* memory;
        std::size_t bytes;
    };
    static constexpr std::size_t kMost = std::size_t{192} << 20;

    Spares() { blocks_.reserve(256); }
    std::mutex mutex_;
    std::vector<Block> blocks_;
    std::size_t bytes_ = 0;
};

/// A picture of 1920 x 1080 bytes is: it fills almost one huge page.
bool is_large(std::size_t bytes) {
    return bytes >= kHugePage / 16 * 15;
}

/// What does not fill a huge page at the end lies on small ones.
std::size_t size_of(std::size_t bytes) {
    return is_large(bytes) ? std::max(kHugePage, rounded_up(bytes, kPage)) : rounded_up(bytes, kCacheLine);
}

}  // namespace

void* allocate_large(std::size_t bytes) {
    const std::size_t size = size_of(bytes);
    if (is_large(bytes))
        if (void* spare = Spares::all().take(size)) return spare;
    // Not std::aligned_alloc: that wants a size that is a multiple of the alignment.
    void* memory = nullptr;
    if (posix_memalign(&memory, is_large(bytes) ? kHugePage : kCacheLine, size) != 0) throw std::bad_alloc();
    if (is_large(bytes)) madvise(memory, size, MADV_HUGEPAGE);  // a wish: without it all works, slower
    return memory;
}

void free_large(void* memory, std::size_t bytes) noexcept {
    if (!is_large(bytes) || !Spares::all().keep(memory, size_of(bytes))) std::free(memory);
}

void release_spare_memory() {
    Spares::all().release();
    malloc_trim(0);
}

}  // namespace planlight
