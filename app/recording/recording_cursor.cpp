#include "app/recording/recording_cursor.h"

#include "planning_io/recording/packed_pictures.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

/// What a person pressed or read has no part in what the session does.
bool goes_nowhere(const std::string& event) {
    return event.starts_with(R"({"what":"pressed")") || event.starts_with(R"({"what":"said")");
}

}  // namespace

/// False at the end.
bool RecordingCursor::read_chunk() {
    auto chunk = reader_.next();
    if (!chunk) return false;
    at_ = chunk->at;
    if (chunk->type == chunk_types::kHead) {
        head_ = std::move(chunk);
    } else if (chunk->type == chunk_types::kRoom) {
        room_ = std::move(chunk);
    } else if (chunk->type == chunk_types::kMatch) {
        match_ = std::move(chunk);
    } else if (chunk->type == chunk_types::kEvent) {
        if (!goes_nowhere(chunk->payload)) next_.push_back({std::move(chunk->payload), {}});
    } else if (chunk->type == chunk_types::kInputs) {
        for (RecordedInput& input : unpacked_inputs(chunk->payload, reader_.file()))
            next_.push_back({{}, std::move(input)});
    } else if (chunk->type == chunk_types::kFrame) {
        // An answer names its frame by the hash of its pictures; it stands before the answer, with a few others at
        // most.
        constexpr std::size_t kKept = 8;
        frames_.push_back(std::move(*chunk));
        if (frames_.size() > kKept) frames_.pop_front();
    } else if (chunk->type == chunk_types::kLost) {
        lost_ = "the disk was too slow or too full when it was recorded: pieces are missing here";
    }
    return true;
}

void RecordingCursor::begin() {
    while (next_.empty() && read_chunk()) {
    }
}

const RecordingCursor::Next& RecordingCursor::peek() {
    while (next_.empty()) {
        if (!lost_.empty()) throw ReplayEnds{lost_};
        if (!read_chunk()) throw ReplayEnds{reader_.sentence()};
    }
    return next_.front();
}

RecordingCursor::Next RecordingCursor::take() {
    peek();
    Next taken = std::move(next_.front());
    next_.pop_front();
    return taken;
}

StereoFrame RecordingCursor::frame(const RecordedInput& input) {
    for (auto chunk = frames_.rbegin(); chunk != frames_.rend(); ++chunk) {
        StereoFrame frame = unpack_frame(chunk->payload, reader_.file());
        if (frame.number != input.number || frame.at != input.at || hash_of(frame) != input.text) continue;
        frame.exposure = input.until;
        return frame;
    }
    throw ReplayEnds{"the pictures of frame " + std::to_string(input.number) + " were not kept"};
}

}  // namespace planlight
