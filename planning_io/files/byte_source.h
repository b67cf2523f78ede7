#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

namespace planlight {

inline constexpr std::uint64_t kMostInflation = 1040;  ///< of what is packed; deflate's limit is 1032 : 1

enum class Packing { none, deflate };  ///< deflate: gzip (of any number of members) or zlib, with their checksums

/// The bytes of a file from `offset` on, unpacked as they are read. Throws InputError when it cannot be opened.
class ByteSource {
public:
    ByteSource(const std::filesystem::path& file, std::uint64_t offset, Packing packing);
    ~ByteSource();
    ByteSource(const ByteSource&) = delete;
    ByteSource& operator=(const ByteSource&) = delete;

    /// Exactly `bytes` bytes; throws DamagedFileError when there are fewer, or when the packed stream is damaged.
    void read(void* to, std::size_t bytes);
    void skip(std::uint64_t bytes);
    /// To be called after the last byte: a packed stream proves its checksum, and more than `allowed` further bytes are
    /// damage. They are put into `rest`, if it is given.
    void finish(std::uint64_t allowed, std::string* rest = nullptr);
    /// The most bytes that can still come out of the file.
    std::uint64_t upper_bound() const;
    const std::filesystem::path& file() const { return file_; }

private:
    struct Inflater;
    std::size_t some(unsigned char* to, std::size_t bytes);
    std::filesystem::path file_;
    std::ifstream in_;
    std::uint64_t stored_bytes_ = 0;
    std::unique_ptr<Inflater> inflater_;
};

/// How a voxel is stored; the volumes themselves are float.
enum class VoxelType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };
std::size_t bytes_of(VoxelType type);

/// `count` voxels as floats, to the end of the source; `allowed` bytes may follow, and are put into `rest`, if it is
/// given. Throws DamagedFileError for too few or too many, or for a voxel that is not a number.
std::vector<float> read_voxels(ByteSource& source, VoxelType type, bool big_endian, std::size_t count,
                               std::uint64_t allowed = 4096, std::string* rest = nullptr);

}  // namespace planlight
