#include "tests/planning_io/recording/kill_writer.h"

#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <random>
#include <thread>

#include "planning_io/recording/packed_pictures.h"
#include "planning_io/recording/recording_reader.h"
#include "planning_io/recording/recording_writer.h"
#include "planning_io/types/error.h"

namespace planlight::test {
namespace {

namespace fs = std::filesystem;

/// What a child tells: outlives it.
struct Told {
    std::atomic<bool> began{false};
    std::atomic<std::uint64_t> added{0}, written{0};
};

StereoFrame frame_of(std::uint64_t number) {
    StereoFrame frame{GrayImage(96, 64), GrayImage(96, 64), Instant(number), Instant(5), number};
    std::mt19937 random(static_cast<unsigned>(number));
    for (auto& p : frame.left.pixels) p = static_cast<std::uint8_t>(random() % 32);
    return frame;
}

[[noreturn]] void write_for_ever(const fs::path& file, Told& told) {
    RecordingWriter writer(std::make_unique<RecordingFile>(file));
    for (std::uint64_t i = 0;; ++i) {
        const bool kept = i % 3 == 0 ? writer.add_picture(chunk_types::kFrame, Instant(i), 12288,
                                                          [i] { return pack_frame(frame_of(i)); })
                                     : writer.add({chunk_types::kEvent, Instant(i), std::to_string(i)});
        if (!kept) ::_exit(3);
        told.began = true;
        told.added = i + 1;
        // What is told is what was written before: a chunk that is told and not in the file was lost.
        told.written = writer.state().written_chunks;
        if (writer.state().waiting_bytes > 1000000) std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
}

/// Empty when the recording holds what it must.
std::string look_at(const fs::path& file, const Told& told, KilledWriters& all) {
    RecordingReader reader(file);
    std::uint64_t number = 0;
    while (const auto chunk = reader.next()) {
        if (chunk->at != Instant(number)) return "a chunk is missing or out of order";
        const bool right = number % 3 == 0 ? unpack_frame(chunk->payload, file).number == number
                                           : chunk->payload == std::to_string(number);
        if (!right) return "a chunk holds something else";
        ++number;
    }
    if (reader.end() != RecordingEnd::cut) return "its end is not told as a cut";
    if (number < told.written) return "a chunk that was written is not there";
    all.chunks += number;
    all.torn += reader.bytes() > reader.bytes_read();
    all.ahead = std::max(all.ahead, static_cast<int>(told.added - std::min<std::uint64_t>(told.added, number)));
    return {};
}

}  // namespace

KilledWriters kill_writers(const fs::path& folder, int count, unsigned seed) {
    KilledWriters all;
    std::mt19937 random(seed);
    for (int i = 0; i < count && all.fault.empty(); ++i) {
        const fs::path file = folder / ("killed-" + std::to_string(i) + ".plrec");
        void* const shared = ::mmap(nullptr, sizeof(Told), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
        Told& told = *new (shared) Told;
        const pid_t child = ::fork();
        if (child == 0) write_for_ever(file, told);
        while (!told.began) std::this_thread::sleep_for(std::chrono::microseconds(100));
        // Until its first bytes are there it is no recording yet, only a file's name.
        while (told.written == 0) std::this_thread::sleep_for(std::chrono::microseconds(100));
        std::this_thread::sleep_for(std::chrono::microseconds(random() % 60000));
        ::kill(child, SIGKILL);
        ::waitpid(child, nullptr, 0);
        try {
            all.fault = look_at(file, told, all);
            all.opened += all.fault.empty();
        } catch (const std::exception& fault) {
            all.fault = fault.what();
        }
        ::munmap(shared, sizeof(Told));
        fs::remove(file);
    }
    return all;
}

}  // namespace planlight::test
