#include "planning_io/recording/recording_reader.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

constexpr std::string_view kMarker = "CHNK";
constexpr const char* kCopyRemedy = "Copy the file again from where it was written.";

template <class T>
T number_at(const char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

}  // namespace

RecordingReader::RecordingReader(const std::filesystem::path& file) : file_(file) {
    std::error_code fault;
    if (!std::filesystem::exists(file, fault))
        throw InputError(file, "does not exist", "Name a recording: a file that ends in .plrec.");
    if (!std::filesystem::is_regular_file(file, fault))
        throw InputError(file, "is no file", "Name a recording: a file that ends in .plrec.");
    bytes_ = std::filesystem::file_size(file, fault);
    in_.open(file, std::ios::binary);
    std::array<char, kRecordingHeaderBytes> header{};
    if (!in_) throw InputError(file, "cannot be read", "A recording can be read by its owner only: ask them.");
    in_.read(header.data(), header.size());
    if (in_.bad()) unreadable(0);
    const std::string wanted = recording_header();
    const auto got = static_cast<std::size_t>(in_.gcount());
    if (got < 8 || std::string_view(header.data(), 8) != std::string_view(wanted).substr(0, 8))
        throw InputError(file, "is no recording of a session", "Name a file that `planlight session` recorded.");
    if (got < header.size()) throw DamagedFileError(file, "ends within its first bytes", kCopyRemedy);
    if (std::string_view(header.data(), header.size()) != wanted) {
        const auto crc = static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(header.data()), 12));
        if (number_at<std::uint32_t>(header.data() + 12) != crc)
            throw DamagedFileError(file, "its first bytes are damaged", kCopyRemedy);
        throw DamagedFileError(
            file, fmt::format("is a recording of version {}", number_at<std::uint32_t>(header.data() + 8)),
            fmt::format("This program reads version {}: use the one that recorded it.", kRecordingVersion));
    }
    at_ = kRecordingHeaderBytes;
}

/// The file's size says that there are bytes, and the disk does not give them: nothing is known of how it ends.
void RecordingReader::unreadable(std::uint64_t at) const {
    throw DiskError(file_, fmt::format("cannot be read at byte {} of {}", at, bytes_),
                    "Look at the disk or the network that it is on, and read it again, or a copy of it.");
}

/// `number`: the only one that is taken; empty: any.
std::optional<RecordingChunk> RecordingReader::whole_chunk_at(std::uint64_t at, std::optional<std::uint64_t> number) {
    if (at > bytes_ || bytes_ - at < kChunkHeaderBytes) return std::nullopt;
    std::array<char, kChunkHeaderBytes> header{};
    in_.clear();
    in_.seekg(static_cast<std::streamoff>(at));
    if (!in_.read(header.data(), header.size())) unreadable(at);
    if (std::string_view(header.data(), 4) != kMarker) return std::nullopt;
    const std::size_t size = number_at<std::uint32_t>(header.data() + 24);
    if (size > kMostPayloadBytes || size > bytes_ - at - kChunkHeaderBytes) return std::nullopt;
    if (number && number_at<std::uint64_t>(header.data() + 8) != *number) return std::nullopt;
    RecordingChunk chunk;
    std::copy_n(header.data() + 4, 4, chunk.type.begin());
    chunk.at = Instant(number_at<std::int64_t>(header.data() + 16));
    chunk.payload.resize(size);
    if (size > 0 && !in_.read(chunk.payload.data(), static_cast<std::streamsize>(size))) unreadable(at);
    uLong crc = crc32_z(0, reinterpret_cast<const Bytef*>(header.data()), kChunkHeaderBytes - 4);
    if (size > 0) crc = crc32_z(crc, reinterpret_cast<const Bytef*>(chunk.payload.data()), size);
    if (number_at<std::uint32_t>(header.data() + 28) != static_cast<std::uint32_t>(crc)) return std::nullopt;
    return chunk;
}

/// What the header of a chunk there says of its payload; empty where there is none that could be whole.
std::optional<std::uint64_t> RecordingReader::payload_bytes_at(std::uint64_t at) {
    if (at > bytes_ || bytes_ - at < kChunkHeaderBytes) return std::nullopt;
    std::array<char, kChunkHeaderBytes> header{};
    in_.clear();
    in_.seekg(static_cast<std::streamoff>(at));
    if (!in_.read(header.data(), header.size())) unreadable(at);
    const std::uint64_t size = number_at<std::uint32_t>(header.data() + 24);
    if (size > kMostPayloadBytes || size > bytes_ - at - kChunkHeaderBytes) return std::nullopt;
    return size;
}

/// Whether any whole chunk stands in the file from that place on, whatever its number: then what does not read there
/// was changed, for a recording that was cut ends there. Not known where the budget does not last for the search.
RecordingEnd RecordingReader::end_from(std::uint64_t at) {
    constexpr std::size_t kBlock = std::size_t{1} << 20;
    std::uint64_t left = search_budget_;
    const auto spend = [&](std::uint64_t bytes) {
        if (bytes > left) return false;
        left -= bytes;
        return true;
    };
    std::string block;
    for (std::uint64_t from = at; from + kChunkHeaderBytes <= bytes_; from += kBlock) {
        block.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kBlock + kMarker.size() - 1, bytes_ - from)));
        if (!spend(block.size())) return RecordingEnd::unknown;
        in_.clear();
        in_.seekg(static_cast<std::streamoff>(from));
        if (!in_.read(block.data(), static_cast<std::streamsize>(block.size()))) unreadable(from);
        for (std::size_t i = block.find(kMarker); i != std::string::npos; i = block.find(kMarker, i + 1)) {
            const auto size = payload_bytes_at(from + i);
            if (!spend(kChunkHeaderBytes + size.value_or(0))) return RecordingEnd::unknown;
            if (size && whole_chunk_at(from + i, std::nullopt)) return RecordingEnd::damaged;
        }
    }
    return RecordingEnd::cut;
}

/// Past a chunk that nobody wants, as far as its header tells; false where it is wanted, or is to be read to be judged:
/// the last one in the file is.
bool RecordingReader::pass_over() {
    if (!wanted_ || at_ > bytes_ || bytes_ - at_ < kChunkHeaderBytes) return false;
    std::array<char, kChunkHeaderBytes> header{};
    in_.clear();
    in_.seekg(static_cast<std::streamoff>(at_));
    if (!in_.read(header.data(), header.size()) || std::string_view(header.data(), 4) != kMarker) return false;
    if (number_at<std::uint64_t>(header.data() + 8) != chunks_) return false;
    ChunkType type{};
    std::copy_n(header.data() + 4, 4, type.begin());
    if (type == chunk_types::kDone || wanted_(type, Instant(number_at<std::int64_t>(header.data() + 16)))) return false;
    const std::uint64_t size = number_at<std::uint32_t>(header.data() + 24);
    if (size > kMostPayloadBytes || size + kChunkHeaderBytes >= bytes_ - at_) return false;
    at_ += kChunkHeaderBytes + size;
    ++chunks_;
    done_seen_ = false;
    return true;
}

std::optional<RecordingChunk> RecordingReader::next() {
    if (end_ != RecordingEnd::open) return std::nullopt;
    for (;;) {
        while (pass_over()) {
        }
        std::optional<RecordingChunk> chunk = whole_chunk_at(at_, chunks_);
        if (!chunk) break;
        at_ += kChunkHeaderBytes + chunk->payload.size();
        ++chunks_;
        done_seen_ = chunk->type == chunk_types::kDone;
        if (!wanted_ || wanted_(chunk->type, chunk->at)) return chunk;  // else the last, or DONE
    }
    if (at_ == bytes_)
        end_ = done_seen_ ? RecordingEnd::whole : RecordingEnd::cut;
    else
        end_ = done_seen_ ? RecordingEnd::damaged : end_from(at_);
    return std::nullopt;
}

std::string RecordingReader::sentence() const {
    if (end_ == RecordingEnd::cut)
        return fmt::format(
            "The recording ends without a closing word, {} chunks long: the session was stopped from "
            "outside, or the disk was full{}.",
            chunks_, bytes_ > at_ ? fmt::format("; the last {} bytes are no whole chunk", bytes_ - at_) : "");
    if (end_ == RecordingEnd::unknown)
        return fmt::format(
            "The recording does not read from byte {} on, and is cut or damaged there: what follows, {} of {} bytes, "
            "looks like more chunks than were searched, and is not used.",
            at_, bytes_ - at_, bytes_);
    if (end_ == RecordingEnd::damaged)
        return fmt::format("The recording is damaged at byte {}: what follows, {} of {} bytes, is not used.", at_,
                           bytes_ - at_, bytes_);
    return {};
}

}  // namespace planlight
