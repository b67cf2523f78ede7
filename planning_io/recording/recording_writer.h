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

/// How a recording fares. `written_bytes` are those in the file; of pictures all others (dropped, waiting) are bytes in
/// memory, before packing.
struct RecordingState {
    std::uint64_t written_chunks = 0, written_bytes = 0;
    std::uint64_t dropped_chunks = 0, dropped_bytes = 0;
    std::size_t waiting_bytes = 0;
    /// Why something does not go its way: with the file, for who looks after the disk, and in a few words without it,
    /// for who looks at the patient. Empty while all is well.
    struct Problem {
        std::string whole, in_few_words;
        bool empty() const { return whole.empty(); }
    };
    Problem problem;       ///< why nothing is written now
    Problem sync_problem;  ///< why what was written may not be on the disk (the first time)
};

/// Writes a recording from a thread of its own, so that no disk, full, slow or gone, ever delays who hands the pieces
/// over. What is dropped is counted, and the counts stand in the recording where it goes on. May be used from any
/// thread.
class RecordingWriter {
public:
    explicit RecordingWriter(std::unique_ptr<RecordingSink> sink, const RecordingWriterSettings& settings = {});
    /// Writes what waits, as `finish` does, but without the last word.
    ~RecordingWriter();
    RecordingWriter(const RecordingWriter&) = delete;
    RecordingWriter& operator=(const RecordingWriter&) = delete;

    /// Never waits for the disk, never throws. False: dropped.
    bool add(RecordingChunk chunk) noexcept;
    /// The same of a picture of `bytes` in memory that `pack` makes the payload of, in the writer's thread.
    bool add_picture(ChunkType type, Instant at, std::size_t bytes, std::function<std::string()> pack) noexcept;

    RecordingState state() const;

    /// Ends the recording: writes what waits and then the last word (DONE: what was dropped in all), as long as the
    /// disk takes it within `end_patience`. What it does not take is dropped with all that comes after it, so that
    /// nothing stands behind a gap. How it fared in the end; nothing is taken afterwards.
    RecordingState finish(Instant at);

private:
    struct Waiting {
        RecordingChunk chunk;
        std::size_t bytes = 0;
        std::function<std::string()> pack;  ///< empty: the chunk holds its payload
    };
    static bool is_own_word(const Waiting& piece);
    static Waiting lost(Instant at, std::uint64_t chunks, std::uint64_t bytes);
    bool queue(Waiting piece, std::size_t limit) noexcept;
    void tell_dropped(Instant at);
    void end(const std::function<void()>& add_last);
    void run();
    std::optional<Waiting> next();
    void write(Waiting piece);
    enum class Written { yes, not_yet, never };
    Written try_to_write(Waiting& piece);
    void drop(const Waiting& piece);
    void put(const RecordingChunk& chunk);
    void sync_now_and_then();
    void sync();
    void note_problem(const std::exception& fault);

    std::unique_ptr<RecordingSink> sink_;
    RecordingWriterSettings settings_;
    mutable std::mutex mutex_;
    std::condition_variable wake_;
    std::deque<Waiting> waiting_;
    RecordingState state_;
    std::uint64_t told_chunks_ = 0, told_bytes_ = 0;  ///< dropped ones that a LOST chunk in the queue speaks of
    bool ending_ = false;
    bool gave_up_ = false;  ///< at the end: the disk did not take a piece; none after it is written
    std::chrono::steady_clock::time_point end_by_{}, synced_at_{};
    bool unsynced_ = false;
    bool header_written_ = false;
    std::thread thread_;
};

}  // namespace planlight
