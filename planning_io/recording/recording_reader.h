#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "planning_io/recording/file_window.h"
#include "planning_io/recording/recording_chunk.h"

namespace planlight {

/// How a recording ends.
enum class RecordingEnd {
    open,     ///< not reached yet
    whole,    ///< the session ended by itself
    cut,      ///< the program or the computer stopped, or the disk was full: after the last whole chunk there is none
    damaged,  ///< bytes were changed: whole chunks follow after what cannot be read
    unknown,  ///< cut or damaged: what follows looks like so many chunks that not all of it was searched
};

/// Whether it may be more than a recording that was cut off at its end.
inline bool may_be_damaged(RecordingEnd end) {
    return end == RecordingEnd::damaged || end == RecordingEnd::unknown;
}

/// Reads a recording chunk by chunk, however long it is; only one chunk is held in memory.
class RecordingReader {
public:
    /// Throws InputError when there is no such file or it is no recording, DamagedFileError when its first bytes are
    /// damaged or of another version, DiskError when the disk does not give its bytes.
    explicit RecordingReader(const std::filesystem::path& file);

    /// So many bytes are read at most to find out whether whole chunks follow what does not read; a hostile file could
    /// ask for each of its bytes a thousand times.
    void search_at_most(std::uint64_t bytes) { search_budget_ = bytes; }

    /// From now on `next` gives the chunks that are wanted, by type and time, only. The others are passed over by their
    /// headers, so that an hour's pictures cost no time; that what they hold is whole is then not looked at.
    using Wanted = std::function<bool(const ChunkType&, Instant)>;
    void want_only(Wanted wanted) { wanted_ = std::move(wanted); }

    /// The next whole chunk; empty at the end, or where the rest cannot be read (see `end`). Never throws for damage;
    /// DiskError where the disk does not give the bytes that the file has.
    std::optional<RecordingChunk> next();

    /// Where the chunk begins in the file that was given last, or that `Wanted` is asked of.
    std::uint64_t place() const { return place_; }
    /// The chunk that begins there, as `place` told; empty where none does that is whole. `next` goes on where it was.
    std::optional<RecordingChunk> chunk_at(std::uint64_t place) { return whole_chunk_at(place, std::nullopt); }

    RecordingEnd end() const { return end_; }
    /// How it ended, in words; empty until then and when it is whole.
    std::string sentence() const;
    std::uint64_t chunks() const { return chunks_; }  ///< read so far
    std::uint64_t bytes_read() const { return at_; }  ///< of whole chunks, with the file's header
    std::uint64_t bytes() const { return bytes_; }    ///< of the file
    const std::filesystem::path& file() const { return file_; }

private:
    std::optional<RecordingChunk> whole_chunk_at(std::uint64_t at, std::optional<std::uint64_t> number);
    std::optional<std::uint64_t> payload_bytes_at(std::uint64_t at);
    std::string_view header_at(std::uint64_t at);
    std::string_view bytes_at(std::uint64_t at, std::size_t count);
    RecordingEnd end_from(std::uint64_t at);
    [[noreturn]] void unreadable(std::uint64_t at) const;

    bool pass_over();

    std::filesystem::path file_;
    Wanted wanted_;  ///< empty: all
    FileWindow in_;
    std::uint64_t bytes_ = 0, at_ = 0, place_ = 0, chunks_ = 0;
    std::uint64_t search_budget_ = std::uint64_t{1} << 30;
    bool done_seen_ = false;
    RecordingEnd end_ = RecordingEnd::open;
};

}  // namespace planlight
