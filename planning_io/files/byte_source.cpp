#include "planning_io/files/byte_source.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "planning_io/files/memory_need.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCopyAgain = "Copy or export the file again.";
constexpr const char* kTooLarge = "Close other programs, or resample the volume to larger voxels.";
constexpr std::size_t kBlock = std::size_t{1} << 18;

template <class T>
float number_at(const unsigned char* at, bool swap) {
    std::array<unsigned char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), at, sizeof(T));
    if (swap) std::reverse(bytes.begin(), bytes.end());
    return static_cast<float>(std::bit_cast<T>(bytes));
}

template <class T>
void append(const std::vector<unsigned char>& bytes, std::size_t count, bool swap, std::vector<float>& values) {
    for (std::size_t i = 0; i < count; ++i) values.push_back(number_at<T>(bytes.data() + i * sizeof(T), swap));
}

void append(VoxelType type, const std::vector<unsigned char>& bytes, std::size_t count, bool swap,
            std::vector<float>& values) {
    switch (type) {
        case VoxelType::int8:
            return append<std::int8_t>(bytes, count, swap, values);
        case VoxelType::uint8:
            return append<std::uint8_t>(bytes, count, swap, values);
        case VoxelType::int16:
            return append<std::int16_t>(bytes, count, swap, values);
        case VoxelType::uint16:
            return append<std::uint16_t>(bytes, count, swap, values);
        case VoxelType::int32:
            return append<std::int32_t>(bytes, count, swap, values);
        case VoxelType::uint32:
            return append<std::uint32_t>(bytes, count, swap, values);
        case VoxelType::int64:
            return append<std::int64_t>(bytes, count, swap, values);
        case VoxelType::uint64:
            return append<std::uint64_t>(bytes, count, swap, values);
        case VoxelType::float32:
            return append<float>(bytes, count, swap, values);
        case VoxelType::float64:
            return append<double>(bytes, count, swap, values);
    }
}

}  // namespace

struct ByteSource::Inflater {
    z_stream stream{};
    std::vector<unsigned char> block = std::vector<unsigned char>(kBlock);
    bool at_end = false;
    Inflater() { inflateInit2(&stream, 15 + 32); }  // gzip or zlib, told apart by their first bytes
    ~Inflater() { inflateEnd(&stream); }
    /// Reads on behind what is not used yet; how many bytes there are to unpack.
    std::size_t fill(std::istream& in) {
        std::copy(stream.next_in, stream.next_in + stream.avail_in, block.data());
        in.read(reinterpret_cast<char*>(block.data() + stream.avail_in),
                static_cast<std::streamsize>(block.size() - stream.avail_in));
        stream.next_in = block.data();
        stream.avail_in += static_cast<uInt>(in.gcount());
        return stream.avail_in;
    }
    /// A gzip file may consist of several (RFC 1952, 2.2), as bgzip and pigz write it.
    bool begin_next_member(std::istream& in) {
        if (stream.avail_in < 2) fill(in);
        if (stream.avail_in < 2 || stream.next_in[0] != 0x1f || stream.next_in[1] != 0x8b) return false;
        return inflateReset(&stream) == Z_OK;
    }
    /// Whether only zeros are left, as a tape or a block device fills up a file.
    bool rest_is_zeros(std::istream& in) {
        while (stream.avail_in > 0 || fill(in) > 0) {
            if (std::any_of(stream.next_in, stream.next_in + stream.avail_in, [](unsigned char c) { return c != 0; }))
                return false;
            stream.avail_in = 0;
        }
        return true;
    }
    Inflater(const Inflater&) = delete;
    Inflater& operator=(const Inflater&) = delete;
};

ByteSource::ByteSource(const fs::path& file, std::uint64_t offset, Packing packing) : file_(file) {
    std::error_code error;
    if (!fs::is_regular_file(file, error))
        throw InputError(file, "is not a readable file", "Check the name of the file.");
    const auto size = fs::file_size(file, error);
    in_.open(file, std::ios::binary);
    if (error || !in_) throw InputError(file, "cannot be opened", "Check the permissions of the file.");
    if (offset > size)
        throw DamagedFileError(file, fmt::format("has {} bytes, and its voxels would begin at byte {}", size, offset),
                               kCopyAgain);
    in_.seekg(static_cast<std::streamoff>(offset));
    stored_bytes_ = size - offset;
    if (packing == Packing::deflate) inflater_ = std::make_unique<Inflater>();
}

ByteSource::~ByteSource() = default;

std::uint64_t ByteSource::upper_bound() const {
    return inflater_ ? stored_bytes_ * kMostInflation : stored_bytes_;
}

std::size_t ByteSource::some(unsigned char* to, std::size_t bytes) {
    if (!inflater_) {
        in_.read(reinterpret_cast<char*>(to), static_cast<std::streamsize>(bytes));
        return static_cast<std::size_t>(in_.gcount());
    }
    z_stream& z = inflater_->stream;
    z.next_out = to;
    z.avail_out = static_cast<uInt>(std::min(bytes, kBlock));
    const uInt wanted = z.avail_out;
    while (z.avail_out == wanted && !inflater_->at_end) {
        if (z.avail_in < 2 && inflater_->fill(in_) == 0)
            throw DamagedFileError(file_, "is cut short: its packed voxels have no end", kCopyAgain);
        const int code = inflate(&z, Z_NO_FLUSH);
        if (code == Z_STREAM_END) {
            inflater_->at_end = !inflater_->begin_next_member(in_);
            if (inflater_->at_end && !inflater_->rest_is_zeros(in_))
                throw DamagedFileError(file_, "goes on after the end of its packed voxels", kCopyAgain);
        } else if (code != Z_OK && code != Z_BUF_ERROR)
            throw DamagedFileError(file_, "is damaged: its packed voxels or their checksum are wrong", kCopyAgain);
    }
    return wanted - z.avail_out;
}

void ByteSource::read(void* to, std::size_t bytes) {
    auto* at = static_cast<unsigned char*>(to);
    for (std::size_t done = 0; done < bytes;) {
        const std::size_t got = some(at + done, bytes - done);
        if (got == 0)
            throw DamagedFileError(file_, fmt::format("is cut short: {} bytes are missing", bytes - done), kCopyAgain);
        done += got;
    }
}

void ByteSource::skip(std::uint64_t bytes) {
    std::vector<unsigned char> rest(static_cast<std::size_t>(std::min<std::uint64_t>(bytes, kBlock)));
    for (; bytes > 0; bytes -= std::min<std::uint64_t>(bytes, rest.size()))
        read(rest.data(), static_cast<std::size_t>(std::min<std::uint64_t>(bytes, rest.size())));
}

void ByteSource::finish(std::uint64_t allowed, std::string* rest) {
    std::vector<unsigned char> block(kBlock);
    std::uint64_t more = 0;
    while (const std::size_t got = some(block.data(), block.size())) {
        more += got;
        if (rest) rest->append(reinterpret_cast<const char*>(block.data()), got);
        if (more > allowed) throw DamagedFileError(file_, "holds more voxels than its header says", kCopyAgain);
    }
}

std::size_t bytes_of(VoxelType type) {
    switch (type) {
        case VoxelType::int8:
        case VoxelType::uint8:
            return 1;
        case VoxelType::int16:
        case VoxelType::uint16:
            return 2;
        case VoxelType::int32:
        case VoxelType::uint32:
        case VoxelType::float32:
            return 4;
        case VoxelType::int64:
        case VoxelType::uint64:
        case VoxelType::float64:
            return 8;
    }
    return 1;
}

std::vector<float> read_voxels(ByteSource& source, VoxelType type, bool big_endian, std::size_t count,
                               std::uint64_t allowed, std::string* rest) {
    const std::size_t each = bytes_of(type);
    if (count > source.upper_bound() / each)
        throw DamagedFileError(
            source.file(), fmt::format("is cut short: it cannot hold the {} voxels of its header", count), kCopyAgain);
    check_memory(fmt::format("{}: reading its {} voxels", source.file().string(), count), count * sizeof(float),
                 kTooLarge);
    std::vector<float> values;
    values.reserve(count);
    std::vector<unsigned char> block(kBlock);
    const bool swap = big_endian != (std::endian::native == std::endian::big);
    while (values.size() < count) {
        const std::size_t now = std::min(count - values.size(), kBlock / each);
        source.read(block.data(), now * each);
        append(type, block, now, swap, values);
    }
    source.finish(allowed, rest);
    const auto odd = std::count_if(values.begin(), values.end(), [](float v) { return !std::isfinite(v); });
    if (odd > 0)
        throw DamagedFileError(source.file(), fmt::format("holds {} voxels that are not numbers", odd),
                               "Replace them by the value of air, and save it again.");
    return values;
}

}  // namespace planlight
