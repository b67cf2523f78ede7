// What is written holds up to the last whole chunk, whatever happens to the program or the disk.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <random>
#include <thread>

#include "planning_io/recording/packed_pictures.h"
#include "planning_io/recording/recording_reader.h"
#include "planning_io/recording/recording_writer.h"
#include "planning_io/types/error.h"
#include "tests/planning_io/recording/kill_writer.h"
#include "tests/planning_io/recording/recording_bytes.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using namespace test;

/// A sink that stands still, is slow, or is full, as a test says.
class FakeDisk final : public RecordingSink {
public:
    struct State {
        std::atomic<bool> still{false}, full{false}, sync_stands_still{false}, sync_fails{false};
        std::atomic<std::size_t> appended{0}, room{1000000000}, syncs{0};
        std::string bytes;
    };
    explicit FakeDisk(State& state) : state_(state) {}
    void append(std::string_view bytes) override {
        while (state_.still) std::this_thread::sleep_for(1ms);
        if (state_.full || bytes.size() > state_.room) throw DiskError("x", "is full", "Make room.");
        state_.room -= bytes.size();
        state_.bytes += bytes;
        ++state_.appended;
    }
    void sync() override {
        ++state_.syncs;
        while (state_.sync_stands_still) std::this_thread::sleep_for(1ms);
        if (state_.sync_fails) throw DiskError("x", "cannot be synced to the disk", "Look at the disk.");
    }

private:
    State& state_;
};

TEST(Recording, ADiskThatStandsStillDelaysNobodyAndWhatIsDroppedIsCountedInTheRecording) {
    const TemporaryFolder folder;
    FakeDisk::State disk;
    disk.still = true;
    RecordingWriterSettings settings;
    settings.most_waiting_bytes = 10000;
    settings.spare_bytes = 5000;
    std::size_t kept = 0, dropped = 0;
    {
        RecordingWriter writer(std::make_unique<FakeDisk>(disk), settings);
        // The disk takes nothing until the last of these calls has come back: none of them can have waited for it.
        for (std::size_t i = 0; i < 1000; ++i)
            ++(writer.add_picture(chunk_types::kFrame, Instant(i), 900, [i] { return text(i); }) ? kept : dropped);
        EXPECT_GE(kept, 10u);
        EXPECT_LE(kept, 13u) << "more waits than was allowed";
        EXPECT_EQ(writer.state().dropped_chunks, dropped);
        // What is no picture still has room.
        EXPECT_TRUE(writer.add({chunk_types::kEvent, Instant(1000), "still told"}));
        disk.still = false;
        while (writer.state().waiting_bytes > 0) std::this_thread::sleep_for(1ms);
        writer.add({chunk_types::kDone, Instant(1001), "{}"});
    }
    const fs::path file = folder.path() / "session.plrec";
    put_bytes(file, disk.bytes);
    RecordingReader reader(file);
    const auto chunks = read_all(reader);
    ASSERT_EQ(chunks.size(), kept + 3);
    EXPECT_EQ(chunks[kept].type, chunk_types::kLost);
    EXPECT_EQ(chunks[kept].payload,
              "{\"chunks\": " + std::to_string(dropped) + ", \"bytes\": " + std::to_string(900 * dropped) + "}");
    EXPECT_EQ(chunks[kept + 1].payload, "still told");
}

TEST(Recording, AFullDiskIsSaidAndTheRecordingGoesOnWhenThereIsRoomAgain) {
    const TemporaryFolder folder;
    FakeDisk::State disk;
    RecordingWriterSettings settings;
    settings.retry_after = 1ms;
    {
        RecordingWriter writer(std::make_unique<FakeDisk>(disk), settings);
        writer.add({chunk_types::kEvent, Instant(0), "before"});
        while (writer.state().written_chunks < 1) std::this_thread::sleep_for(1ms);
        disk.full = true;
        writer.add({chunk_types::kEvent, Instant(1), "waits"});
        while (writer.state().problem.empty()) std::this_thread::sleep_for(1ms);
        EXPECT_EQ(writer.state().problem.whole, "x: is full");
        disk.full = false;
        while (writer.state().written_chunks < 2) std::this_thread::sleep_for(1ms);
        EXPECT_TRUE(writer.state().problem.empty());
    }
    const fs::path file = folder.path() / "session.plrec";
    put_bytes(file, disk.bytes);
    RecordingReader reader(file);
    EXPECT_EQ(read_all(reader).size(), 2u);
}

TEST(Recording, WhatComesWhileTheDiskIsSyncedAtTheEndIsWritten) {
    const TemporaryFolder folder;
    FakeDisk::State disk;
    RecordingWriterSettings settings;
    settings.sync_every = 1ms;
    RecordingWriter writer(std::make_unique<FakeDisk>(disk), settings);
    disk.sync_stands_still = true;
    writer.add({chunk_types::kEvent, Instant(0), text(0)});
    while (disk.syncs == 0) std::this_thread::sleep_for(1ms);
    // The writer's thread has found nothing more to write, and waits for the disk.
    for (std::size_t i = 1; i < 20; ++i) writer.add({chunk_types::kEvent, Instant(i), text(i)});
    std::thread ending([&] { writer.finish(Instant(20)); });
    // From when on nothing is taken the end has begun.
    while (writer.add({chunk_types::kEvent, Instant(21), "later"})) std::this_thread::sleep_for(1ms);
    disk.sync_stands_still = false;
    ending.join();
    const fs::path file = folder.path() / "session.plrec";
    put_bytes(file, disk.bytes);
    RecordingReader reader(file);
    const auto chunks = read_all(reader);
    ASSERT_GE(chunks.size(), 21u);
    for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(chunks[i].payload, text(i));
    EXPECT_EQ(reader.end(), RecordingEnd::whole);
}

TEST(Recording, OfWhichTheDiskDidNotTakeAPieceAtTheEndIsCutThereAndNeverWhole) {
    const TemporaryFolder folder;
    FakeDisk::State disk;
    RecordingState state;
    {
        RecordingWriter writer(std::make_unique<FakeDisk>(disk));
        writer.add({chunk_types::kEvent, Instant(0), "before"});
        while (writer.state().written_chunks < 1) std::this_thread::sleep_for(1ms);
        disk.room = 200;  // for the last word, and not for the frame before it
        writer.add_picture(chunk_types::kFrame, Instant(1), 4800, [] { return pack_frame(noisy_frame(1)); });
        writer.add({chunk_types::kEvent, Instant(2), "behind a gap"});
        state = writer.finish(Instant(3));
    }
    const fs::path file = folder.path() / "session.plrec";
    put_bytes(file, disk.bytes);
    RecordingReader reader(file);
    EXPECT_EQ(read_all(reader).size(), 1u) << "what stands behind a gap looks like its neighbour";
    EXPECT_EQ(reader.end(), RecordingEnd::cut);
    EXPECT_EQ(state.dropped_chunks, 2u) << "the frame and the event; the last word is no piece of the session";
    EXPECT_EQ(state.problem.whole, "x: is full");
}

TEST(Recording, ItsLastWordCountsAllThatWasDroppedWhenItIsWritten) {
    const TemporaryFolder folder;
    FakeDisk::State disk;
    RecordingWriterSettings settings;
    settings.most_waiting_bytes = 10000;
    {
        RecordingWriter writer(std::make_unique<FakeDisk>(disk), settings);
        writer.add_picture(chunk_types::kFrame, Instant(0), 100000, [] { return text(0); });  // never has room
        writer.add({chunk_types::kEvent, Instant(1), text(1)});
        writer.add_picture(chunk_types::kFrame, Instant(2), 50, []() -> std::string { throw std::bad_alloc(); });
        EXPECT_EQ(writer.finish(Instant(3)).dropped_chunks, 2u);
    }
    const fs::path file = folder.path() / "session.plrec";
    put_bytes(file, disk.bytes);
    RecordingReader reader(file);
    const auto chunks = read_all(reader);
    ASSERT_EQ(chunks.size(), 4u);
    EXPECT_EQ(chunks[0].payload, R"({"chunks": 1, "bytes": 100000})");
    EXPECT_EQ(chunks[2].payload, R"({"chunks": 1, "bytes": 50})") << "said where it lacks";
    EXPECT_EQ(chunks[3].payload, R"({"dropped_chunks": 2, "dropped_bytes": 100050})");
    EXPECT_EQ(reader.end(), RecordingEnd::whole);
}

TEST(Recording, ASyncThatFailedIsToldForGood) {
    FakeDisk::State disk;
    RecordingWriterSettings settings;
    settings.sync_every = 1ms;
    RecordingWriter writer(std::make_unique<FakeDisk>(disk), settings);
    disk.sync_fails = true;
    writer.add({chunk_types::kEvent, Instant(0), text(0)});
    while (writer.state().sync_problem.empty()) std::this_thread::sleep_for(1ms);
    disk.sync_fails = false;
    writer.add({chunk_types::kEvent, Instant(1), text(1)});
    EXPECT_EQ(writer.finish(Instant(2)).sync_problem.whole, "x: cannot be synced to the disk");
}

TEST(Recording, ALimitOnTheFilesSizeLeavesWholeChunksAndEndsNothing) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "session.plrec";
    constexpr rlim_t kLimit = 20000;
    const pid_t child = ::fork();
    if (child == 0) {
        const rlimit limit{kLimit, kLimit};
        ::setrlimit(RLIMIT_FSIZE, &limit);
        int code = 0;
        {
            RecordingWriterSettings settings;
            settings.retry_after = 1ms;
            RecordingWriter writer(std::make_unique<RecordingFile>(file), settings);
            for (std::size_t i = 0; i < 400; ++i) writer.add({chunk_types::kEvent, Instant(i), text(i)});
            while (writer.state().problem.empty()) std::this_thread::sleep_for(1ms);
            if (writer.state().problem.in_few_words != "File too large") code = 1;
        }
        ::_exit(code);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
    RecordingReader reader(file);
    const auto chunks = read_all(reader);
    EXPECT_GT(chunks.size(), 20u);
    for (std::size_t i = 0; i < chunks.size(); ++i) EXPECT_EQ(chunks[i].payload, text(i));
    EXPECT_EQ(reader.end(), RecordingEnd::cut);
    EXPECT_EQ(reader.bytes_read(), reader.bytes()) << "half a chunk was left behind";
}

TEST(Recording, KilledAtAnyInstantItOpensAndHoldsAllThatWasWritten) {
    const TemporaryFolder folder;
    const test::KilledWriters killed = test::kill_writers(folder.path(), 30, 1);
    EXPECT_EQ(killed.opened, 30);
    EXPECT_EQ(killed.fault, "");
    EXPECT_GT(killed.chunks, 30u) << "nothing was written before the end";
}

}  // namespace
}  // namespace planlight
