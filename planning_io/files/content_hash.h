#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>

namespace planlight {

/// XXH3-128 over several pieces of memory (little endian, as in memory), as 32 hex digits.
class ContentHash {
public:
    ContentHash();
    ~ContentHash();
    void add_bytes(const void* data, std::size_t bytes);
    /// The text and a closing zero byte, so that "ab" + "c" differs from "a" + "bc".
    void add(std::string_view text);
    template <class T>
    void add_values(const T* data, std::size_t count) {
        static_assert(std::is_arithmetic_v<T>);
        add_bytes(data, count * sizeof(T));
    }
    std::string hex() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// XXH3-128 of one piece, as 32 hex digits.
std::string content_hash(std::string_view content);

/// The same of a file, read piece by piece. Throws InputError when it cannot be read, and what `go_on` throws, which is
/// called between two pieces and may be empty.
std::string content_hash_of(const std::filesystem::path& file, const std::function<void()>& go_on = {});

}  // namespace planlight
