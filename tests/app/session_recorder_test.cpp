// Which frames `--record events` keeps.
#include "app/recording/session_recorder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <random>
#include <thread>
#include <vector>

#include "planning_io/files/disk_refusal.h"
#include "planning_io/recording/packed_pictures.h"
#include "planning_io/recording/recording_file.h"
#include "planning_io/recording/recording_reader.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

using std::chrono::milliseconds;

/// Numbers of the frames that are kept of four seconds at 25 frames/s, in which something happens after frame 40.
std::vector<std::uint64_t> kept_when(const std::function<void(SessionRecorder&)>& something) {
    const test::TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "session.plrec";
    {
        SessionRecorder recorder(std::make_unique<RecordingFile>(file), {});
        for (int i = 0; i < 100; ++i) {
            recorder.frame_taken({GrayImage(32, 24, 5), GrayImage(32, 24, 9), milliseconds(40 * i), milliseconds(5),
                                  static_cast<std::uint64_t>(i)});
            if (i == 40) something(recorder);
        }
        EXPECT_EQ(recorder.finish(), "");
    }
    std::vector<std::uint64_t> numbers;
    RecordingReader reader(file);
    while (const auto chunk = reader.next())
        if (chunk->type == chunk_types::kFrame) numbers.push_back(unpack_frame(chunk->payload, file).number);
    return numbers;
}

/// One every two seconds, and the twelve before and after what happened.
std::vector<std::uint64_t> round_frame_40() {
    std::vector<std::uint64_t> numbers{0};
    for (std::uint64_t i = 29; i <= 52; ++i) numbers.push_back(i);
    numbers.push_back(53);  // two seconds after the first one are over
    return numbers;
}

TEST(RecordedEvents, WhileNothingHappensAFrameEveryTwoSecondsIsKept) {
    EXPECT_EQ(kept_when([](SessionRecorder&) {}), (std::vector<std::uint64_t>{0, 50}));
}

TEST(RecordedEvents, FramesRoundAPersonsPressAreKept) {
    EXPECT_EQ(kept_when([](SessionRecorder& r) { r.pressed("confirm"); }), round_frame_40());
}

TEST(RecordedEvents, FramesRoundAFaultOfADeviceAreKept) {
    EXPECT_EQ(
        kept_when([](SessionRecorder& r) { r.device_failed(DeviceError("left camera", "is gone", "plug it in")); }),
        round_frame_40());
}

TEST(RecordedEvents, FramesRoundAnotherWordOfTheGateAreKeptAndRoundTheSameWordAreNot) {
    LightGate::Ruling look;
    look.trust = LightTrust::look;
    look.headline = "LOOK";
    EXPECT_EQ(kept_when([&](SessionRecorder& r) { r.gate(GateCall::step, {}, 0, &look); }), round_frame_40());
    EXPECT_EQ(kept_when([&](SessionRecorder& r) {
                  for (int i = 0; i < 3; ++i) r.gate(GateCall::step, {}, 0, &look);
              }),
              round_frame_40());
}

TEST(RecordedEvents, WhatHappensBeforeTheFirstFrameKeepsTheFirstFrames) {
    const test::TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "session.plrec";
    {
        SessionRecorder recorder(std::make_unique<RecordingFile>(file), {});
        recorder.pressed("scan");
        for (int i = 0; i < 30; ++i)
            recorder.frame_taken({GrayImage(32, 24, 5), GrayImage(32, 24, 9), milliseconds(40 * i), milliseconds(5),
                                  static_cast<std::uint64_t>(i)});
        EXPECT_EQ(recorder.finish(), "");
    }
    int frames = 0;
    RecordingReader reader(file);
    while (const auto chunk = reader.next()) frames += chunk->type == chunk_types::kFrame;
    EXPECT_EQ(frames, 13) << "twelve after the press, and the next of the usual ones";
}

/// A disk that is full, or whose power is gone.
class FullDisk final : public RecordingSink {
public:
    explicit FullDisk(bool takes) : takes_(takes) {}
    void append(std::string_view) override {
        if (!takes_) refuse("cannot be written: No space left on device");
    }
    void sync() override { refuse("cannot be synced to the disk: No space left on device"); }

private:
    [[noreturn]] static void refuse(const std::string& how) {
        throw DiskRefusal("/srv/cases/MEIER/a.plrec", how, "Make room.",
                          std::make_error_code(std::errc::no_space_on_device));
    }
    bool takes_;
};

/// Whoever stands at the table may read the banner: it says what is wrong, and no folder that may be called as somebody
/// is. Who looks after the disk is told the file, when the recording ends.
TEST(RecorderTrouble, NamesNoFileInTheBannerAndDoesAtTheEnd) {
    for (const bool takes : {false, true}) {
        RecordingWriterSettings quick;
        quick.retry_after = quick.sync_every = milliseconds(1);
        SessionRecorder recorder(std::make_unique<FullDisk>(takes), {}, quick);
        while (recorder.trouble().empty()) std::this_thread::sleep_for(milliseconds(1));
        const std::string said = recorder.trouble();
        EXPECT_NE(said.find(takes ? "The disk did not confirm the recording: No space left on device;"
                                  : "The recording stands still: No space left on device"),
                  std::string::npos)
            << said;
        EXPECT_EQ(said.find('/'), std::string::npos) << said;
        EXPECT_NE(recorder.finish().find("/srv/cases/MEIER/a.plrec"), std::string::npos);
    }
}

/// What is said of an hour's size holds of the file, whatever fills it: words of the gate that are long, and frames
/// that do not pack.
TEST(RecordedEvents, TheWholeRecordingKeepsWithinItsBudget) {
    constexpr double kBytesPerS = 100e3, kAhead = 200e3;
    constexpr int kSeconds = 60, kFramesPerS = 25;
    FrameChoiceSettings small;
    small.bytes_per_s = kBytesPerS, small.bytes_ahead = kAhead;
    GrayImage noise(120, 80);
    std::mt19937 random(1);
    for (std::uint8_t& pixel : noise.pixels) pixel = static_cast<std::uint8_t>(random() & 0xFFU);
    for (const std::size_t words : {10U, 3000U}) {
        const test::TemporaryFolder folder;
        const std::filesystem::path file = folder.path() / "session.plrec";
        SessionRecorder recorder(std::make_unique<RecordingFile>(file), {}, {}, small);
        LightGate::Ruling ruling;
        ruling.details = {std::string(words, 'x')};
        for (int i = 0; i < kSeconds * kFramesPerS; ++i) {
            const Instant at = i * std::chrono::milliseconds(1000 / kFramesPerS);
            recorder.frame_taken({noise, noise, at, milliseconds(5), static_cast<std::uint64_t>(i)});
            recorder.picture_shown(RgbImage(64, 48, {0, 255, 0}), at, at);
            // A minute passes in no time here: how well they pack must be known first. HEAD, the frame, the light.
            while (i == 0 && recorder.state().written_chunks < 3) std::this_thread::sleep_for(milliseconds(1));
            ruling.headline = "headline " + std::to_string(i / 10);
            recorder.gate(GateCall::step, at, 0, &ruling);
        }
        EXPECT_EQ(recorder.finish(), "");
        const auto bytes = static_cast<double>(std::filesystem::file_size(file));
        EXPECT_LE(bytes, 1.05 * (kAhead + kBytesPerS * kSeconds)) << words << ": of each picture it is a guess";
        EXPECT_GE(bytes, 0.5 * kBytesPerS * kSeconds) << words << ": there was room for frames";
    }
}

}  // namespace
}  // namespace planlight
