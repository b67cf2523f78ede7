#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "planning_io/recording/recording_chunk.h"
#include "planning_io/recording/recording_file.h"

namespace planlight {

struct RecordingWriterSettings {
    /// Pictures that wait for the disk; what comes while more wait is dropped.
    std::size_t most_waiting_bytes = std::size_t{256} << 20;
    /// So much more for what is no picture: it is small, and worth more.
    std::size_t spare_bytes = std::size_t{16} << 20;
    Instant sync_every = std::chrono::seconds(1);     ///< a power cut loses so much at most, and what waits
    Instant retry_after = std::chrono::seconds(1);    ///< when the disk refused
    Instant end_patience = std::chrono::seconds(10);  ///< at the end, for a disk that is slow
};

/// How a recording fares. Bytes are those of the chunks.
struct RecordingState {
    std::uint64_t written_chunks = 0, written_bytes = 0;
    std::uint64_t dropped_chunks = 0, dropped_bytes = 0;
    std::size_t waiting_bytes = 0;
    std::string problem;  ///< why nothing is written now, in words; empty while all is well
};

/// Writes a recording from a thread of its own, so that no disk, full, slow or gone, ever delays who hands the pieces
/// over. What is dropped is counted, and the counts stand in the recording where it goes on. May be used from any
/// thread.
class RecordingWriter {
public:
    explicit RecordingWriter(std::unique_ptr<RecordingSink> sink, const RecordingWriterSettings& settings = {});
    /// Writes what waits, as long as the disk takes it within `end_patience`.
    ~RecordingWriter();
    RecordingWriter(const RecordingWriter&) = delete;
    RecordingWriter& operator=(const RecordingWriter&) = delete;

    /// Never waits for the disk, never throws. False: dropped.
    bool add(RecordingChunk chunk) noexcept;
    /// The same of a picture of `bytes` in memory that `pack` makes the payload of, in the writer's thread.
    bool add_picture(ChunkType type, Instant at, std::size_t bytes, std::function<std::string()> pack) noexcept;

    RecordingState state() const;

private:
    struct Waiting {
        RecordingChunk chunk;
        std::size_t bytes = 0;
        std::function<std::string()> pack;
    };
    bool queue(Waiting piece, std::size_t limit) noexcept;
    void run();
    std::optional<Waiting> next();
    void write(Waiting piece);
    void put(const RecordingChunk& chunk);
    void sync_now_and_then();
    void note_problem(const std::string& problem);

    std::unique_ptr<RecordingSink> sink_;
    RecordingWriterSettings settings_;
    mutable std::mutex mutex_;
    std::condition_variable wake_;
    std::deque<Waiting> waiting_;
    RecordingState state_;
    std::uint64_t told_chunks_ = 0, told_bytes_ = 0;  ///< dropped ones that a LOST chunk in the queue speaks of
    bool ending_ = false;
    std::chrono::steady_clock::time_point end_by_{}, synced_at_{};
    bool unsynced_ = false;
    bool header_written_ = false;
    std::thread thread_;
};

}  // namespace planlight
