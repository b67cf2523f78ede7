#include "planning_io/recording/recording_reader.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>

#include "planning_io/files/check_exists.h"
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

RecordingReader::RecordingReader(const std::filesystem::path& file) : file_(file), in_(file) {
    check_exists(file, "Name a recording: a file that ends in .plrec.");
    std::error_code fault;
    if (!std::filesystem::is_regular_file(file, fault))
        throw InputError(file, "is no file", "Name a recording: a file that ends in .plrec.");
    bytes_ = std::filesystem::file_size(file, fault);
    if (!in_.opened()) throw InputError(file, "cannot be read", "A recording can be read by its owner only: ask them.");
    const std::string_view header = in_.bytes(0, kRecordingHeaderBytes);
    if (in_.failed()) unreadable(0);
    const std::string wanted = recording_header();
    if (header.substr(0, 8) != std::string_view(wanted).substr(0, 8))
        throw InputError(file, "is no recording of a session", "Name a file that `planlight session` recorded.");
    if (header.size() < kRecordingHeaderBytes) throw DamagedFileError(file, "ends within its first bytes", kCopyRemedy);
    if (header != wanted) {
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

/// Of bytes that the file has.
std::string_view RecordingReader::bytes_at(std::uint64_t at, std::size_t count) {
    const std::string_view bytes = in_.bytes(at, count);
    if (bytes.size() < count) unreadable(at);
    return bytes;
}

/// Empty where there is no room for one.
std::string_view RecordingReader::header_at(std::uint64_t at) {
    if (at > bytes_ || bytes_ - at < kChunkHeaderBytes) return {};
    return bytes_at(at, kChunkHeaderBytes);
}

/// `number`: the only one that is taken; empty: any.
std::optional<RecordingChunk> RecordingReader::whole_chunk_at(std::uint64_t at, std::optional<std::uint64_t> number) {
    const std::string_view header = header_at(at);
    if (header.empty() || header.substr(0, 4) != kMarker) return std::nullopt;
    const std::size_t size = number_at<std::uint32_t>(header.data() + 24);
    if (size > kMostPayloadBytes || size > bytes_ - at - kChunkHeaderBytes) return std::nullopt;
    if (number && number_at<std::uint64_t>(header.data() + 8) != *number) return std::nullopt;
    const auto crc_told = number_at<std::uint32_t>(header.data() + 28);
    RecordingChunk chunk;
    std::copy_n(header.data() + 4, 4, chunk.type.begin());
    chunk.at = Instant(number_at<std::int64_t>(header.data() + 16));
    uLong crc = crc32_z(0, reinterpret_cast<const Bytef*>(header.data()), kChunkHeaderBytes - 4);
    const std::string_view payload = bytes_at(at + kChunkHeaderBytes, size);  // `header` is gone from here on
    if (size > 0) crc = crc32_z(crc, reinterpret_cast<const Bytef*>(payload.data()), size);
    if (crc_told != static_cast<std::uint32_t>(crc)) return std::nullopt;
    chunk.payload = payload;
    return chunk;
}

/// What the header of a chunk there says of its payload; empty where there is none that could be whole.
std::optional<std::uint64_t> RecordingReader::payload_bytes_at(std::uint64_t at) {
    const std::string_view header = header_at(at);
    if (header.empty()) return std::nullopt;
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
    for (std::uint64_t from = at; from + kChunkHeaderBytes <= bytes_; from += kBlock) {
        const auto count =
            static_cast<std::size_t>(std::min<std::uint64_t>(kBlock + kMarker.size() - 1, bytes_ - from));
        if (!spend(count)) return RecordingEnd::unknown;
        const std::string block(bytes_at(from, count));
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
    if (!wanted_) return false;
    const std::string_view header = header_at(at_);
    if (header.empty() || header.substr(0, 4) != kMarker) return false;
    if (number_at<std::uint64_t>(header.data() + 8) != chunks_) return false;
    ChunkType type{};
    std::copy_n(header.data() + 4, 4, type.begin());
    place_ = at_;
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
        place_ = at_;
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
