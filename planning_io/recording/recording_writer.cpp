#include "planning_io/recording/recording_writer.h"

#include <fmt/format.h>

#include <exception>

#include "planning_io/files/disk_refusal.h"

namespace planlight {

using Wall = std::chrono::steady_clock;

namespace {

RecordingState::Problem problem_of(const std::exception& fault) {
    if (const auto* refusal = dynamic_cast<const DiskRefusal*>(&fault)) return {fault.what(), refusal->why.message()};
    const bool by_disk = dynamic_cast<const DiskError*>(&fault) != nullptr;
    return {fault.what(), by_disk ? "the disk refuses it" : fault.what()};
}

}  // namespace

RecordingWriter::RecordingWriter(std::unique_ptr<RecordingSink> sink, const RecordingWriterSettings& settings)
    : sink_(std::move(sink)), settings_(settings), synced_at_(Wall::now()), thread_([this] { run(); }) {}

RecordingWriter::~RecordingWriter() {
    end({});
}

RecordingState RecordingWriter::finish(Instant at) {
    end([&] {
        tell_dropped(at);
        const auto last_word = [this] {
            const RecordingState now = state();
            return fmt::format(R"({{"dropped_chunks": {}, "dropped_bytes": {}}})", now.dropped_chunks,
                               now.dropped_bytes);
        };
        waiting_.push_back({{chunk_types::kDone, at, {}}, 0, last_word});
    });
    return state();
}

void RecordingWriter::end(const std::function<void()>& add_last) {
    if (!thread_.joinable()) return;
    {
        const std::lock_guard lock(mutex_);
        if (add_last) add_last();
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

bool RecordingWriter::is_own_word(const Waiting& piece) {
    return piece.chunk.type == chunk_types::kLost || piece.chunk.type == chunk_types::kDone;
}

RecordingWriter::Waiting RecordingWriter::lost(Instant at, std::uint64_t chunks, std::uint64_t bytes) {
    return {{chunk_types::kLost, at, fmt::format(R"({{"chunks": {}, "bytes": {}}})", chunks, bytes)}, 0, {}};
}

/// What was dropped before is told in its place, so that nobody takes what follows for its neighbour.
void RecordingWriter::tell_dropped(Instant at) {
    if (state_.dropped_chunks == told_chunks_) return;
    waiting_.push_back(lost(at, state_.dropped_chunks - told_chunks_, state_.dropped_bytes - told_bytes_));
    told_chunks_ = state_.dropped_chunks, told_bytes_ = state_.dropped_bytes;
}

bool RecordingWriter::queue(Waiting piece, std::size_t limit) noexcept {
    const std::size_t bytes = piece.bytes;
    const auto refuse = [&] {
        ++state_.dropped_chunks;
        state_.dropped_bytes += bytes;
        return false;
    };
    try {
        {
            const std::lock_guard lock(mutex_);
            if (ending_ || state_.waiting_bytes + bytes > limit) return refuse();
            tell_dropped(piece.chunk.at);
            waiting_.push_back(std::move(piece));
            state_.waiting_bytes += bytes;
        }
        wake_.notify_one();
        return true;
    } catch (const std::exception&) {  // no memory: the light is worth more than its recording
        const std::lock_guard lock(mutex_);
        return refuse();
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
        if (std::optional<Waiting> piece = next()) write(std::move(*piece));
        sync_now_and_then();
        const std::lock_guard lock(mutex_);
        // Asked here and not of `next`: while the disk was synced the last pieces may have come.
        if (ending_ && (waiting_.empty() || gave_up_ || Wall::now() > end_by_)) break;
    }
    {
        const std::lock_guard lock(mutex_);
        for (const Waiting& piece : waiting_) drop(piece);
        waiting_.clear();
    }
    sync();
}

/// `never`: not because of the disk; no memory to pack it, or it is too large for a chunk.
RecordingWriter::Written RecordingWriter::try_to_write(Waiting& piece) {
    try {
        if (piece.pack) piece.chunk.payload = piece.pack();
        piece.pack = {};
        put(piece.chunk);
        return Written::yes;
    } catch (const DiskError& fault) {
        note_problem(fault);
        return Written::not_yet;
    } catch (const std::exception& fault) {
        note_problem(fault);
        return is_own_word(piece) ? Written::not_yet : Written::never;
    }
}

/// Tries until the disk takes it, for what comes later must not stand before it; more and more is dropped meanwhile.
void RecordingWriter::write(Waiting piece) {
    for (Written written{}; (written = try_to_write(piece)) != Written::yes;) {
        std::unique_lock lock(mutex_);
        if (written == Written::never) {  // said in its place
            drop(piece);
            ++told_chunks_, told_bytes_ += piece.bytes;
            piece = lost(piece.chunk.at, 1, piece.bytes);
            continue;
        }
        wake_.wait_for(lock, settings_.retry_after, [&] { return ending_; });
        if (!ending_) continue;
        gave_up_ = true;
        drop(piece);
        return;
    }
    const std::lock_guard lock(mutex_);
    state_.waiting_bytes -= piece.bytes;
}

/// Asks for the lock.
void RecordingWriter::drop(const Waiting& piece) {
    state_.waiting_bytes -= piece.bytes;
    // Words of the writer's own, not pieces that anybody handed over.
    if (is_own_word(piece)) return;
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
    state_.problem = {};
}

void RecordingWriter::sync_now_and_then() {
    if (!unsynced_ || Wall::now() - synced_at_ < settings_.sync_every) return;
    sync();
    unsynced_ = false;
    synced_at_ = Wall::now();
}

/// A sync that failed is never made good by the next: the system may have thrown away what it could not write.
void RecordingWriter::sync() {
    try {
        sink_->sync();
    } catch (const std::exception& fault) {
        const std::lock_guard lock(mutex_);
        if (state_.sync_problem.empty()) state_.sync_problem = problem_of(fault);
    }
}

void RecordingWriter::note_problem(const std::exception& fault) {
    const std::lock_guard lock(mutex_);
    state_.problem = problem_of(fault);
}

}  // namespace planlight
