#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "planning_io/types/time.h"

namespace planlight {

/// What a chunk of a recording holds: four letters, as they stand in the file (FORMATS.md).
using ChunkType = std::array<char, 4>;

namespace chunk_types {
inline constexpr ChunkType kHead{'H', 'E', 'A', 'D'};     ///< JSON: whose recording this is; always the first
inline constexpr ChunkType kRoom{'R', 'O', 'O', 'M'};     ///< JSON: devices and their calibration
inline constexpr ChunkType kEvent{'E', 'V', 'N', 'T'};    ///< JSON: what was asked of the session, and what came of it
inline constexpr ChunkType kInputs{'I', 'N', 'P', 'T'};   ///< what the devices answered, in order
inline constexpr ChunkType kFrame{'F', 'R', 'A', 'M'};    ///< both cameras' pictures, lossless
inline constexpr ChunkType kPicture{'L', 'I', 'T', 'E'};  ///< a picture that was handed to the projector
inline constexpr ChunkType kMatch{'M', 'T', 'C', 'H'};    ///< JSON: a match, with all that it takes to go on with it
inline constexpr ChunkType kLost{'L', 'O', 'S', 'T'};     ///< JSON: what the disk was too slow or too full for
inline constexpr ChunkType kDone{'D', 'O', 'N', 'E'};     ///< JSON: the session ended by itself; always the last
}  // namespace chunk_types

/// One piece of a recording.
struct RecordingChunk {
    ChunkType type{};
    Instant at{};  ///< on the session's clock
    std::string payload;
};

inline constexpr std::uint32_t kRecordingVersion = 1;
inline constexpr std::size_t kRecordingHeaderBytes = 16, kChunkHeaderBytes = 32;
inline constexpr std::size_t kMostPayloadBytes = std::size_t{256} << 20;

/// The first bytes of a recording.
std::string recording_header();

/// A chunk as it stands in the file: its header with a checksum over both, then the payload. `number` counts chunks
/// from 0. Throws std::length_error for a payload of more than `kMostPayloadBytes`.
std::string chunk_bytes(const RecordingChunk& chunk, std::uint64_t number);

}  // namespace planlight
