// What was recorded of a session is replayed by the same code to the last digit, and a difference is named.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <thread>

#include "app/recording/recorded_inputs.h"
#include "app/recording/replay_session.h"
#include "planning_io/recording/packed_pictures.h"
#include "planning_io/types/error.h"
#include "tests/app/recorded_kinds.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using test::PlayedSession;

class Replay : public ::testing::Test {
protected:
    void SetUp() override {
        if (!test::example_case().there) GTEST_SKIP() << "the package invesalius-examples is not installed";
    }
};

/// A disk that takes nothing until it is told to.
class StillDisk final : public RecordingSink {
public:
    explicit StillDisk(const std::atomic<bool>& still) : still_(still) {}
    void append(std::string_view) override {
        while (still_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    void sync() override {}

private:
    const std::atomic<bool>& still_;
};

TEST_F(Replay, ADiskThatTakesNothingLeavesTheLightAloneAndIsSaid) {
    std::atomic<bool> still{true};
    struct LetGo {  // whatever ends the test: the recorder waits for its disk
        std::atomic<bool>& still;
        ~LetGo() { still = false; }
    };
    RecordingWriterSettings writing;
    writing.most_waiting_bytes = 3'000'000;
    writing.spare_bytes = 10'000;
    SessionRecorder recorder(std::make_unique<StillDisk>(still),
                             recording_head(test::example_case().prepared, {}, RecordMode::all, {}), writing);
    const LetGo let_go{still};
    PlayedSession how;
    how.seed = 5;
    how.updates = 20;
    // Scan, match and light come to their end while the disk has not taken a byte: nothing of it waited.
    const test::PlayedResult played = test::play_session(how, test::example_case(), &recorder);
    EXPECT_GE(played.updates, 20);
    EXPECT_GE(recorder.state().dropped_chunks, 40u) << "a scan of 46 pictures and 20 updates, and room for three";
    EXPECT_LE(recorder.state().waiting_bytes, 3'010'000u);
    EXPECT_NE(recorder.trouble().find("the light is not affected"), std::string::npos) << recorder.trouble();
}

/// One recording that is spoilt in many ways.
class SpoiltRecording : public Replay {
protected:
    void SetUp() override {
        Replay::SetUp();
        if (IsSkipped() || !chunks_.empty()) return;
        PlayedSession how;
        how.seed = 2;
        how.updates = 24;
        how.dark_in_scan = true;  // a refusal that is none of an update
        how.exposures_told = true;
        const fs::path file = folder().path() / "sound.plrec";
        test::record_session(how, test::example_case(), RecordMode::all, file);
        chunks_ = test::chunks_of(file);
    }
    static test::TemporaryFolder& folder() {
        static test::TemporaryFolder made;
        return made;
    }
    static ReplayResult replay(const std::vector<RecordingChunk>& chunks) {
        const fs::path file = folder().path() / "spoilt.plrec";
        test::write_recording(chunks, file);
        return replay_session(file, test::example_case().prepared);
    }
    /// The n-th event of an update.
    static std::size_t update(int n) {
        for (std::size_t i = 0; i < chunks_.size(); ++i)
            if (chunks_[i].payload.starts_with(R"({"what":"updated")") && --n == 0) return i;
        return 0;
    }
    static std::vector<RecordingChunk> chunks_;
};
std::vector<RecordingChunk> SpoiltRecording::chunks_;

TEST_F(SpoiltRecording, APoseOfWhichOneDigitIsAnotherIsNamedWithItsFrame) {
    auto chunks = chunks_;
    const std::size_t seventh = update(7);
    ASSERT_GT(seventh, 0u);
    std::string& text = chunks[seventh].payload;
    const std::size_t at = text.find("residual_px\":0.") + 15;
    text[at] = text[at] == '1' ? '2' : '1';
    const ReplayResult replayed = replay(chunks);
    ASSERT_TRUE(replayed.difference);
    EXPECT_EQ(replayed.difference->update, 7);
    EXPECT_EQ(replayed.updates, 6);
    EXPECT_NE(replayed.difference->what.find("pose.residual_px"), std::string::npos) << replayed.difference->what;
}

TEST_F(SpoiltRecording, OneGreyOfOnePixelOfOneFrameIsFoundOut) {
    auto chunks = chunks_;
    std::size_t at = update(5);
    while (chunks[at].type != chunk_types::kFrame) --at;
    StereoFrame frame = unpack_frame(chunks[at].payload, "x");
    frame.left.at(100, 100) ^= 1;
    chunks[at].payload = pack_frame(frame);
    const ReplayResult replayed = replay(chunks);
    EXPECT_FALSE(replayed.difference);
    EXPECT_EQ(replayed.updates, 4) << "its pictures are not those that the session saw";
    EXPECT_NE(replayed.ended.find("frame " + std::to_string(frame.number)), std::string::npos) << replayed.ended;
}

TEST_F(SpoiltRecording, AClockThatSaysAnotherTimeGivesAnotherPictureOrWord) {
    auto chunks = chunks_;
    std::size_t at = update(6);
    while (chunks[at].type != chunk_types::kInputs) --at;  // a press from another thread may stand between
    auto inputs = unpacked_inputs(chunks[at].payload, "x");
    for (RecordedInput& input : inputs)
        if (input.kind == RecordedInput::Kind::clock) input.at += std::chrono::milliseconds(3);
    chunks[at].payload = packed(inputs);
    EXPECT_TRUE(replay(chunks).difference);
}

TEST_F(SpoiltRecording, OfWhoseExposuresOneIsNotToldAnotherOrderIsNamed) {
    auto chunks = chunks_;
    const auto told = [](const RecordedInput& input) { return input.kind == RecordedInput::Kind::exposed; };
    for (auto& chunk : chunks) {
        if (chunk.type != chunk_types::kInputs) continue;
        auto inputs = unpacked_inputs(chunk.payload, "x");
        const auto first = std::ranges::find_if(inputs, told);
        if (first == inputs.end()) continue;
        inputs.erase(first);
        chunk.payload = packed(inputs);
        const ReplayResult replayed = replay(chunks);
        ASSERT_TRUE(replayed.difference);
        EXPECT_NE(replayed.difference->what.find("the order of things"), std::string::npos)
            << replayed.difference->what;
        return;
    }
    ADD_FAILURE() << "none was told";
}

TEST_F(SpoiltRecording, WhatWasDroppedEndsTheReplayWithWords) {
    auto chunks = chunks_;
    const std::size_t at = update(4);
    std::size_t frame = at;
    while (chunks[frame].type != chunk_types::kFrame) --frame;
    chunks[frame] = {chunk_types::kLost, chunks[frame].at, R"({"chunks": 1, "bytes": 857000})"};
    const ReplayResult replayed = replay(chunks);
    EXPECT_FALSE(replayed.difference);
    EXPECT_EQ(replayed.updates, 3);
    EXPECT_NE(replayed.ended.find("pieces are missing"), std::string::npos);
}

TEST_F(SpoiltRecording, CutAnywhereItIsReplayedUpToThere) {
    for (const std::size_t length : {std::size_t{3}, std::size_t{40}, update(1), update(9) + 1}) {
        auto chunks = chunks_;
        chunks.resize(length);
        const ReplayResult replayed = replay(chunks);
        EXPECT_FALSE(replayed.difference) << length << ": " << replayed.difference->what;
        EXPECT_NE(replayed.ended, "") << length;
    }
}

TEST_F(SpoiltRecording, IsRefusedForAnotherCaseAndWithoutItsFrames) {
    const fs::path file = folder().path() / "other.plrec";
    test::write_recording(chunks_, file);
    Case other = test::example_case().prepared;
    other.plan_hash = "another";
    EXPECT_THROW(replay_session(file, other), InputError);
    auto chunks = chunks_;
    const std::size_t at = chunks.front().payload.find("\"all\"");
    ASSERT_NE(at, std::string::npos);
    chunks.front().payload.replace(at, 5, "\"events\"");
    test::write_recording(chunks, file);
    EXPECT_THROW(replay_session(file, test::example_case().prepared), InputError);
}

TEST_F(SpoiltRecording, IsRefusedWhereItsRoomIsOfAnotherKindOfWords) {
    auto chunks = chunks_;
    const auto entered =
        std::ranges::find_if(chunks, [](const RecordingChunk& c) { return c.type == chunk_types::kRoom; });
    ASSERT_NE(entered, chunks.end());
    const std::string word = "\"simulated\":true";
    ASSERT_NE(entered->payload.find(word), std::string::npos);
    entered->payload.replace(entered->payload.find(word), word.size(), "\"simulated\":\"yes\"");
    EXPECT_THROW(replay(chunks), DamagedFileError);
}

TEST_F(SpoiltRecording, IsRefusedWhereItDoesNotSayItsMarkersOrTheWayItWasRecorded) {
    for (const auto& [name, other] :
         {std::pair{"\"disc_mm\"", "\"disk_mm\""}, {"\"sticker_mm\":", "\"sticker_mm\":\"\",\"x\":"}}) {
        auto chunks = chunks_;
        const auto entered =
            std::ranges::find_if(chunks, [](const RecordingChunk& c) { return c.type == chunk_types::kRoom; });
        ASSERT_NE(entered, chunks.end());
        std::string& room = entered->payload;
        ASSERT_NE(room.find(name), std::string::npos);
        room.replace(room.find(name), std::string(name).size(), other);
        EXPECT_THROW(replay(chunks), InputError) << other;
    }
    auto chunks = chunks_;
    std::string& head = chunks.front().payload;
    head.replace(head.find("\"all\""), 5, "\"alles\"");
    EXPECT_THROW(replay(chunks), InputError);
}

}  // namespace
}  // namespace planlight
