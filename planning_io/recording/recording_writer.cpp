#include "planning_io/recording/recording_writer.h"

#include <fmt/format.h>

#include <exception>

#include "planning_io/types/error.h"

namespace planlight {

using Wall = std::chrono::steady_clock;

RecordingWriter::RecordingWriter(std::unique_ptr<RecordingSink> sink, const RecordingWriterSettings& settings)
    : sink_(std::move(sink)), settings_(settings), synced_at_(Wall::now()), thread_([this] { run(); }) {}

RecordingWriter::~RecordingWriter() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
        end_by_ = Wall::now() + settings_.end_patience;
    }
    wake_.notify_all();
    thread_.join();
}

bool RecordingWriter::add(RecordingChunk chunk) noexcept {
    const std::size_t bytes = chunk.payload.size() + kChunkHeaderBytes;
    return queue({std::move(chunk), bytes, {}}, settings_.most_waiting_bytes + settings_.spare_bytes);
}

bool RecordingWriter::add_picture(ChunkType type, Instant at, std::size_t bytes,
                                  std::function<std::string()> pack) noexcept {
    return queue({{type, at, {}}, bytes, std::move(pack)}, settings_.most_waiting_bytes);
}

/// What was dropped before is told in its place, so that nobody takes what follows for its neighbour.
bool RecordingWriter::queue(Waiting piece, std::size_t limit) noexcept {
    try {
        {
            const std::lock_guard lock(mutex_);
            if (state_.waiting_bytes + piece.bytes > limit) {
                ++state_.dropped_chunks;
                state_.dropped_bytes += piece.bytes;
                return false;
            }
            if (state_.dropped_chunks > told_chunks_) {
                std::string text = fmt::format(R"({{"chunks": {}, "bytes": {}}})", state_.dropped_chunks - told_chunks_,
                                               state_.dropped_bytes - told_bytes_);
                waiting_.push_back({{chunk_types::kLost, piece.chunk.at, std::move(text)}, 0, {}});
                told_chunks_ = state_.dropped_chunks, told_bytes_ = state_.dropped_bytes;
            }
            state_.waiting_bytes += piece.bytes;
            waiting_.push_back(std::move(piece));
        }
        wake_.notify_one();
        return true;
    } catch (const std::exception&) {  // no memory: the light is worth more than its recording
        return false;
    }
}

RecordingState RecordingWriter::state() const {
    const std::lock_guard lock(mutex_);
    return state_;
}

/// Empty: the end, or only something to be synced.
std::optional<RecordingWriter::Waiting> RecordingWriter::next() {
    std::unique_lock lock(mutex_);
    const auto ready = [&] { return ending_ || !waiting_.empty(); };
    if (unsynced_)
        wake_.wait_until(lock, synced_at_ + settings_.sync_every, ready);
    else
        wake_.wait(lock, ready);
    if (waiting_.empty()) return std::nullopt;
    Waiting piece = std::move(waiting_.front());
    waiting_.pop_front();
    return piece;
}

void RecordingWriter::run() {
    for (;;) {
        std::optional<Waiting> piece = next();
        const bool nothing_left = !piece;
        if (piece) write(std::move(*piece));
        sync_now_and_then();
        const std::lock_guard lock(mutex_);
        if (ending_ && (nothing_left || Wall::now() > end_by_)) break;
    }
    try {
        sink_->sync();
    } catch (const std::exception& fault) {
        note_problem(fault.what());
    }
}

/// Tries until the disk takes it, for what comes later must not stand before it; more and more is dropped meanwhile.
void RecordingWriter::write(Waiting piece) {
    bool written = false;
    for (bool packed = false; !written;) {
        try {
            if (piece.pack && !packed) piece.chunk.payload = piece.pack();
            packed = true;
            put(piece.chunk);
            written = true;
        } catch (const std::exception& fault) {
            note_problem(fault.what());
            if (!packed) break;
            std::unique_lock lock(mutex_);
            wake_.wait_for(lock, settings_.retry_after, [&] { return ending_; });
            if (ending_) break;
        }
    }
    const std::lock_guard lock(mutex_);
    state_.waiting_bytes -= piece.bytes;
    if (written) return;
    ++state_.dropped_chunks;
    state_.dropped_bytes += piece.bytes;
}

void RecordingWriter::put(const RecordingChunk& chunk) {
    if (!header_written_) sink_->append(recording_header());
    header_written_ = true;
    std::uint64_t number = 0;
    {
        const std::lock_guard lock(mutex_);
        number = state_.written_chunks;
    }
    const std::string bytes = chunk_bytes(chunk, number);
    sink_->append(bytes);
    unsynced_ = true;
    const std::lock_guard lock(mutex_);
    ++state_.written_chunks;
    state_.written_bytes += bytes.size();
    state_.problem.clear();
}

void RecordingWriter::sync_now_and_then() {
    if (!unsynced_ || Wall::now() - synced_at_ < settings_.sync_every) return;
    try {
        sink_->sync();
    } catch (const std::exception& fault) {
        note_problem(fault.what());
    }
    unsynced_ = false;
    synced_at_ = Wall::now();
}

void RecordingWriter::note_problem(const std::string& problem) {
    const std::lock_guard lock(mutex_);
    state_.problem = problem;
}

}  // namespace planlight
