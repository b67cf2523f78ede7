#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace planlight {

/// Numbers and texts one after the other, little endian, unpadded.
class FieldWriter {
public:
    template <class T>
    void add(T value) {
        char bytes[sizeof(T)];
        std::memcpy(bytes, &value, sizeof(T));
        bytes_.append(bytes, sizeof(T));
    }
    void add_text(const std::string& text);  ///< uint32 length, then its bytes
    const std::string& bytes() const { return bytes_; }

private:
    std::string bytes_;
};

/// Reads what FieldWriter wrote. Throws DamagedFileError past the end.
class FieldReader {
public:
    FieldReader(std::string_view bytes, const std::filesystem::path& file) : bytes_(bytes), file_(file) {}
    template <class T>
    T next() {
        T value;
        std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
        return value;
    }
    std::string next_text();
    std::string_view take(std::size_t count);
    std::size_t left() const { return bytes_.size(); }
    void expect_end() const;

private:
    std::string_view bytes_;
    const std::filesystem::path& file_;
};

/// Memory that is written as, or filled from, compressed chunks. Of elements of 4 bytes the differences are stored.
struct ChunkedArray {
    std::byte* data;
    std::size_t bytes, element_bytes;
};

/// A view of `values`, which must outlive it.
template <class T, class Allocator>
ChunkedArray array_of(std::vector<T, Allocator>& values) {
    return {reinterpret_cast<std::byte*>(values.data()), values.size() * sizeof(T), sizeof(T)};
}

struct ChunkedKind {
    const char* magic;  ///< 8 bytes
    std::uint32_t version;
};

/// A file of header fields and arrays in chunks of 1 MiB, all under checksums; the layout stands in the room's README.
void write_chunked(std::ostream& out, const ChunkedKind& kind, const std::string& fields,
                   const std::vector<ChunkedArray>& arrays);

/// Such a file in memory. Every flipped bit, cut or added byte is a DamagedFileError.
class ChunkedFile {
public:
    ChunkedFile(std::string_view content, const ChunkedKind& kind, const std::filesystem::path& file);
    const std::string& fields() const { return fields_; }
    /// Verifies and unpacks all chunks, on all processors; the arrays must have the sizes that were written.
    void read_into(const std::vector<ChunkedArray>& arrays) const;

private:
    struct Chunk {
        std::uint64_t stored_bytes, hash_high, hash_low;
    };
    const std::filesystem::path& file_;
    std::string fields_;
    std::vector<Chunk> chunks_;
    std::string_view stored_;
};

}  // namespace planlight
