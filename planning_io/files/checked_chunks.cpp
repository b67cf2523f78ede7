#include "planning_io/files/checked_chunks.h"

#include <tbb/parallel_for.h>
#include <xxhash.h>
#include <zstd.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <memory>

#include "planning_io/types/error.h"
#include "planning_io/types/processor_clones.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little, "the file is little endian");

constexpr std::size_t kChunkBytes = std::size_t{1} << 20;
constexpr std::uint32_t kEndianMark = 0x01020304;
constexpr int kLevel = 1;

[[noreturn]] void damaged(const fs::path& file, const std::string& problem) {
    throw DamagedFileError(file, problem, "Prepare the case again, or copy its folder again.");
}

struct Slice {
    std::byte* data;
    std::size_t bytes, element_bytes;
};

std::vector<Slice> slices_of(const std::vector<ChunkedArray>& arrays) {
    std::vector<Slice> slices;
    for (const ChunkedArray& a : arrays)
        for (std::size_t at = 0; at < a.bytes; at += kChunkBytes)
            slices.push_back({a.data + at, std::min(kChunkBytes, a.bytes - at), a.element_bytes});
    return slices;
}

/// Differences of 4-byte elements, first bytes first: neighbours in a table are alike, so most bytes become zero.
PLANLIGHT_CLONES void split_bytes(const std::uint32_t* values, std::size_t count, std::uint8_t* out) {
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t difference = values[i] - (i > 0 ? values[i - 1] : 0);
        for (std::size_t byte = 0; byte < 4; ++byte)
            out[byte * count + i] = static_cast<std::uint8_t>(difference >> (8 * byte));
    }
}

PLANLIGHT_CLONES void join_bytes(const std::uint8_t* in, std::size_t count, std::uint32_t* values) {
    const std::uint8_t *b0 = in, *b1 = in + count, *b2 = b1 + count, *b3 = b2 + count;
    for (std::size_t i = 0; i < count; ++i)
        values[i] = static_cast<std::uint32_t>(b0[i]) | static_cast<std::uint32_t>(b1[i]) << 8 |
                    static_cast<std::uint32_t>(b2[i]) << 16 | static_cast<std::uint32_t>(b3[i]) << 24;
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < count; ++i) values[i] = sum += values[i];
}

std::string compress(const Slice& slice) {
    std::vector<std::uint8_t> split;
    const void* source = slice.data;
    if (slice.element_bytes == 4) {
        split.resize(slice.bytes);
        split_bytes(reinterpret_cast<const std::uint32_t*>(slice.data), slice.bytes / 4, split.data());
        source = split.data();
    }
    std::string packed(ZSTD_compressBound(slice.bytes), '\0');
    const std::size_t size = ZSTD_compress(packed.data(), packed.size(), source, slice.bytes, kLevel);
    if (ZSTD_isError(size)) throw std::runtime_error("zstd could not compress");
    packed.resize(size);
    packed.shrink_to_fit();  // all chunks wait for the last: a megabyte each would be the table once more
    return packed;
}

/// False when the chunk does not unpack to exactly the slice.
bool decompress(std::string_view packed, const Slice& slice) {
    thread_local const std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context(ZSTD_createDCtx(),
                                                                                       ZSTD_freeDCtx);
    thread_local std::vector<std::uint8_t> split;
    void* target = slice.data;
    if (slice.element_bytes == 4) {
        split.resize(kChunkBytes);
        target = split.data();
    }
    if (ZSTD_decompressDCtx(context.get(), target, slice.bytes, packed.data(), packed.size()) != slice.bytes)
        return false;
    if (slice.element_bytes == 4)
        join_bytes(split.data(), slice.bytes / 4, reinterpret_cast<std::uint32_t*>(slice.data));
    return true;
}

}  // namespace

void FieldWriter::add_text(const std::string& text) {
    add(static_cast<std::uint32_t>(text.size()));
    bytes_ += text;
}

std::string_view FieldReader::take(std::size_t count) {
    if (count > bytes_.size()) damaged(file_, "is cut short");
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
}

std::string FieldReader::next_text() {
    return std::string(take(next<std::uint32_t>()));
}

void FieldReader::expect_end() const {
    if (!bytes_.empty()) damaged(file_, "goes on after its end");
}

void write_chunked(std::ostream& out, const ChunkedKind& kind, const std::string& fields,
                   const std::vector<ChunkedArray>& arrays) {
    const std::vector<Slice> slices = slices_of(arrays);
    std::vector<std::string> packed(slices.size());
    tbb::parallel_for(std::size_t{0}, slices.size(), [&](std::size_t i) { packed[i] = compress(slices[i]); });
    FieldWriter header;
    for (int i = 0; i < 8; ++i) header.add(kind.magic[i]);
    header.add(kind.version);
    header.add(kEndianMark);
    header.add_text(fields);
    header.add(static_cast<std::uint32_t>(packed.size()));
    for (const std::string& chunk : packed) {
        const XXH128_hash_t hash = XXH3_128bits(chunk.data(), chunk.size());
        header.add(static_cast<std::uint64_t>(chunk.size()));
        header.add(hash.high64);
        header.add(hash.low64);
    }
    const XXH128_hash_t hash = XXH3_128bits(header.bytes().data(), header.bytes().size());
    header.add(hash.high64);
    header.add(hash.low64);
    out.write(header.bytes().data(), static_cast<std::streamsize>(header.bytes().size()));
    for (const std::string& chunk : packed) out.write(chunk.data(), static_cast<std::streamsize>(chunk.size()));
}

ChunkedFile::ChunkedFile(std::string_view content, const ChunkedKind& kind, const fs::path& file) : file_(file) {
    FieldReader in(content, file);
    if (in.take(8) != std::string_view(kind.magic, 8))
        damaged(file, "is not a file of this kind, or its beginning is damaged");
    const auto version = in.next<std::uint32_t>(), mark = in.next<std::uint32_t>();
    if (mark != kEndianMark) damaged(file, "was written on a machine of the other byte order, or is damaged");
    if (version != kind.version)
        damaged(file, "is of version " + std::to_string(version) + "; this program reads version " +
                          std::to_string(kind.version));
    fields_ = in.next_text();
    const auto count = in.next<std::uint32_t>();
    if (count > in.left() / sizeof(Chunk)) damaged(file, "is cut short");
    std::uint64_t total = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        Chunk chunk{};
        chunk.stored_bytes = in.next<std::uint64_t>();
        chunk.hash_high = in.next<std::uint64_t>();
        chunk.hash_low = in.next<std::uint64_t>();
        if (chunk.stored_bytes > 2 * kChunkBytes) damaged(file, "is damaged in its header");
        total += chunk.stored_bytes;
        chunks_.push_back(chunk);
    }
    const XXH128_hash_t hash = XXH3_128bits(content.data(), content.size() - in.left());
    if (in.next<std::uint64_t>() != hash.high64 || in.next<std::uint64_t>() != hash.low64)
        damaged(file, "is damaged in its header");
    if (in.left() != total) damaged(file, in.left() < total ? "is cut short" : "goes on after its end");
    stored_ = in.take(in.left());
}

void ChunkedFile::read_into(const std::vector<ChunkedArray>& arrays) const {
    const std::vector<Slice> slices = slices_of(arrays);
    if (slices.size() != chunks_.size()) damaged(file_, "does not hold the chunks that its sizes say");
    std::vector<std::size_t> begins(chunks_.size());
    for (std::size_t i = 1; i < chunks_.size(); ++i) begins[i] = begins[i - 1] + chunks_[i - 1].stored_bytes;
    std::atomic<std::size_t> first_bad{chunks_.size()};
    tbb::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t i) {
        const std::string_view packed = stored_.substr(begins[i], chunks_[i].stored_bytes);
        const XXH128_hash_t hash = XXH3_128bits(packed.data(), packed.size());
        const bool good =
            hash.high64 == chunks_[i].hash_high && hash.low64 == chunks_[i].hash_low && decompress(packed, slices[i]);
        if (!good) first_bad = std::min<std::size_t>(first_bad, i);
    });
    if (first_bad < chunks_.size())
        damaged(file_, "is damaged in chunk " + std::to_string(first_bad) + " of " + std::to_string(chunks_.size()));
}

}  // namespace planlight
