#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace planlight {

/// Memory on huge pages where it is large and the system has them: the first touch of 64 MiB takes 4 ms instead of 30
/// ms. Up to 192 MiB that were freed are kept for the next of the same sizes. Throws std::bad_alloc.
void* allocate_large(std::size_t bytes);

/// Of `allocate_large` with the same number of bytes.
void free_large(void* memory, std::size_t bytes) noexcept;

/// For LargeArray: `allocate_large`, and elements that are not touched before they are written.
template <class T>
struct LargeAllocator {
    using value_type = T;
    LargeAllocator() = default;
    template <class U>
    LargeAllocator(const LargeAllocator<U>&) noexcept {}
    T* allocate(std::size_t count) { return static_cast<T*>(allocate_large(count * sizeof(T))); }
    void deallocate(T* memory, std::size_t count) noexcept { free_large(memory, count * sizeof(T)); }
    template <class U>
    void construct(U* at) noexcept {
        ::new (static_cast<void*>(at)) U;  // no value: not touched
    }
    template <class U, class... Arguments>
    void construct(U* at, Arguments&&... arguments) {
        std::construct_at(at, std::forward<Arguments>(arguments)...);
    }
    bool operator==(const LargeAllocator&) const { return true; }
};

/// A std::vector for large tables of numbers. `resize(n)` leaves new elements without a value, for who fills all of
/// them; `resize(n, value)` and `assign` work as ever.
template <class T>
using LargeArray = std::vector<T, LargeAllocator<T>>;

}  // namespace planlight
