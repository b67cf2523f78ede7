// measure_killed_sessions [COUNT] [SEED] [UPDATES]: COUNT (300) recorded sessions are killed (SIGKILL) at random
// instants. Each is a program of its own: the real session on the recorded devices of one session of the simulated
// paper's room (every frame, no rendering), with the real recorder, every other one with `--record all`. Of each
// recording: does it open, does it end at its last whole chunk, are its events the first ones of the session, is all
// there that its program had been told is written, and is a match offered exactly where one stood. Exit code 0 when
// all of it holds.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <map>
#include <random>
#include <thread>

#include "app/recording/recording_head.h"
#include "app/recording/recording_time_line.h"
#include "app/recording/replay_session.h"
#include "app/recording/resume_offer.h"
#include "app/session_observers.h"
#include "planning_io/case/case_folder.h"
#include "tests/app/played_session.h"
#include "tests/support/test_data.h"

namespace {

using namespace planlight;
namespace fs = std::filesystem;
using std::chrono::steady_clock;

enum class Phase { starting, scanning, scanned, matched, following };
constexpr std::array kPhaseWords{"before the scan", "scanning", "finding the patient", "patient found", "following"};

/// What the killed program tells; outlives it.
struct Told {
    std::atomic<bool> began{false}, match_written{false}, match_handed_over{false}, done{false};
    std::atomic<std::uint64_t> written{0}, updates{0};
    std::atomic<int> frames{0};  ///< that the session has taken, of its scan too
    std::atomic<Phase> phase{Phase::starting};
};

Told& told_in(const fs::path& file) {
    const int shared = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (shared < 0 || ::ftruncate(shared, sizeof(Told)) != 0) throw std::runtime_error("no file to tell in");
    void* const place = ::mmap(nullptr, sizeof(Told), PROT_READ | PROT_WRITE, MAP_SHARED, shared, 0);
    ::close(shared);
    if (place == MAP_FAILED) throw std::runtime_error("no memory to tell in");
    return *static_cast<Told*>(place);
}

/// Tells what is in the file, once it is.
class TellingFile final : public RecordingSink {
public:
    TellingFile(const fs::path& file, Told& told) : file_(file), told_(told) {}
    void append(std::string_view bytes) override {
        file_.append(bytes);
        if (bytes.size() < kChunkHeaderBytes) return;  // the file's own first bytes
        ++told_.written;
        if (bytes.substr(4, 4) == "MTCH") told_.match_written = true;
    }
    void sync() override { file_.sync(); }

private:
    RecordingFile file_;
    Told& told_;
};

/// Tells how far the session is.
class Telling final : public SessionObserver {
public:
    explicit Telling(Told& told) : told_(told) {}
    void room_entered(const RoomFacts&) noexcept override { told_.began = true; }
    void asked(SessionCall call, const std::vector<PointPair>&, int) noexcept override {
        if (call == SessionCall::scan) told_.phase = Phase::scanning;
        if (call == SessionCall::update) told_.phase = Phase::following;
    }
    void frame_taken(const StereoFrame&) noexcept override { ++told_.frames; }
    void scanned(const Session&) noexcept override { told_.phase = Phase::scanned; }
    void matched(const Session&) noexcept override {
        told_.phase = Phase::matched;
        told_.match_handed_over = true;
    }
    void updated(const Session&, const Session::Update&) noexcept override { ++told_.updates; }

private:
    Told& told_;
};

int record(const fs::path& devices, const fs::path& case_folder, const fs::path& file, RecordMode mode,
           const fs::path& told_file) {
    Told& told = told_in(told_file);
    const Case the_case = read_case(case_folder);
    SessionRecorder recorder(std::make_unique<TellingFile>(file, told),
                             recording_head(the_case, case_folder, mode, {}));
    Telling telling(told);
    SessionObservers both;
    both.add(&telling);  // before the recorder has it: else a match may be in the file that nobody told of
    both.add(&recorder);
    const ReplayResult result = replay_session(devices, the_case, {}, both.all());
    recorder.finish();
    told.done = true;
    return result.difference ? 1 : 0;
}

/// Without the time of day that it was asked for something.
std::string without_utc(std::string event) {
    const std::size_t at = event.find(",\"utc\":\"");
    if (at != std::string::npos) event.erase(at, event.find('"', at + 8) + 1 - at);
    return event;
}

std::vector<std::string> events_of(const fs::path& file, RecordingReader& reader) {
    std::vector<std::string> events;
    while (const auto chunk = reader.next())
        if (chunk->type == chunk_types::kEvent) events.push_back(without_utc(chunk->payload));
    if (reader.end() == RecordingEnd::open) throw std::runtime_error(file.string() + " has no end");
    return events;
}

/// Of all of them.
struct Sums {
    int opened = 0, ended = 0, torn = 0, offered = 0, whole = 0;
    std::uint64_t chunks = 0, most_waiting_events = 0;
    std::map<std::string, int> phases, why_none;
    std::array<int, 10> tenths{};  ///< of the session, in which it was killed
    std::vector<std::string> faults;
};

class Kills {
public:
    Kills(const fs::path& program, const fs::path& folder, fs::path devices, fs::path case_folder)
        : program_(program), folder_(folder), devices_(std::move(devices)), case_folder_(std::move(case_folder)) {
        const auto began = steady_clock::now();
        const auto [child, told] = start("whole", RecordMode::events);
        int status = 0;
        ::waitpid(child, &status, 0);
        if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) throw std::runtime_error("the session itself fails");
        lasts_s_ = std::chrono::duration<double>(steady_clock::now() - began).count();
        RecordingReader reader(folder_ / "whole.plrec");
        events_ = events_of(folder_ / "whole.plrec", reader);
        frames_ = told->frames;
        ::munmap(told, sizeof(Told));
    }
    double lasts_s() const { return lasts_s_; }

    /// When that share of the session's frames is taken, and so much later.
    void kill_one(RecordMode mode, double share, std::chrono::microseconds later, Sums& sums) {
        const std::string name = "killed";
        const auto [child, told] = start(name, mode);
        // Until its first chunk is there it is no recording yet, only a file's name.
        while (told->written == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        const int frames = static_cast<int>(share * (frames_ + 1));
        while (told->frames < frames && !told->done) std::this_thread::sleep_for(std::chrono::microseconds(200));
        std::this_thread::sleep_for(later);
        ::kill(child, SIGKILL);
        ::waitpid(child, nullptr, 0);
        sums.tenths[static_cast<std::size_t>(std::min(9, 10 * told->frames / frames_))]++;
        ++sums.phases[told->done ? "ended before it was killed"
                                 : kPhaseWords[static_cast<std::size_t>(told->phase.load())]];
        const fs::path file = folder_ / (name + ".plrec");
        try {
            look_at(file, *told, sums);
        } catch (const std::exception& fault) {
            sums.faults.push_back(fault.what());
        }
        ::munmap(told, sizeof(Told));
        fs::remove(file);
    }

private:
    std::pair<pid_t, Told*> start(const std::string& name, RecordMode mode) {
        const fs::path told_file = folder_ / "told";
        fs::remove(told_file);
        Told& told = *new (&told_in(told_file)) Told;
        const pid_t child = ::fork();
        if (child == 0) {
            ::execl(program_.c_str(), program_.c_str(), "--record", devices_.c_str(), case_folder_.c_str(),
                    (folder_ / (name + ".plrec")).c_str(), word_of(mode), told_file.c_str(), nullptr);
            ::_exit(127);
        }
        return {child, &told};
    }

    void look_at(const fs::path& file, const Told& told, Sums& sums) {
        const auto must = [&](bool holds, const std::string& what) {
            if (!holds) sums.faults.push_back(what);
        };
        RecordingReader reader(file);
        const auto events = events_of(file, reader);
        ++sums.opened;
        sums.chunks += reader.chunks();
        sums.torn += reader.bytes() > reader.bytes_read();
        const bool whole = reader.end() == RecordingEnd::whole;
        sums.whole += whole;
        must(whole || reader.end() == RecordingEnd::cut, "its end is told as damage");
        must(reader.chunks() >= told.written,
             fmt::format("{} of {} chunks that were written", reader.chunks(), told.written.load()));
        const bool first = events.size() <= events_.size() && std::equal(events.begin(), events.end(), events_.begin());
        std::size_t i = 0;
        while (i < std::min(events.size(), events_.size()) && events[i] == events_[i]) ++i;
        must(first, fmt::format("event {} of {} is another than that of the session ({}): {}, not {}", i, events.size(),
                                events_.size(), i < events.size() ? events[i].substr(0, 300) : "",
                                i < events_.size() ? events_[i].substr(0, 300) : ""));
        sums.ended += first && reader.chunks() >= told.written && !may_be_damaged(reader.end());
        time_line_of(file);  // what `review` shows of it
        offer_of(file, told, sums, must);
    }

    template <class Must>
    void offer_of(const fs::path& file, const Told& told, Sums& sums, const Must& must) {
        const LastMatch last = last_match_of(file);
        if (told.match_written) must(last.match.has_value(), "a match stood, and is not offered: " + last.why_none);
        if (!told.match_handed_over) must(!last.match, "a match is offered where none was");
        if (!last.match) {
            ++sums.why_none[last.why_none];
            return;
        }
        resume_offer(file, test::example_case().prepared);  // names of case, plan and program agree, or it throws
        ++sums.offered;
    }

    const fs::path program_, folder_, devices_, case_folder_;
    std::vector<std::string> events_;  ///< of the session that nobody killed
    double lasts_s_ = 0;
    int frames_ = 1;  ///< of it
};

void print(const Sums& sums, int count) {
    fmt::print(
        "{} of {} open; {} of {} end at the last whole chunk with all that was written, their events the first ones of "
        "the session ({} chunks; {} with the beginning of a chunk behind them, which is left out; {} had ended by "
        "themselves); {} offer a match\n",
        sums.opened, count, sums.ended, count, sums.chunks, sums.torn, sums.whole, sums.offered);
    fmt::print("killed in the tenths of the session's frames: {}\n", fmt::join(sums.tenths, ", "));
    for (const auto& [phase, times] : sums.phases) fmt::print("killed while {}: {}\n", phase, times);
    for (const auto& [why, times] : sums.why_none) fmt::print("no match offered, {}: {}\n", why, times);
    for (const std::string& fault : sums.faults) fmt::print("FAULT: {}\n", fault);
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> words(argv + 1, argv + argc);
    if (words.size() == 6 && words[0] == "--record")
        return record(words[1], words[2], words[3], record_mode_of(words[4]), words[5]);
    const int count = words.empty() ? 300 : std::stoi(words[0]);
    const unsigned seed = words.size() > 1 ? static_cast<unsigned>(std::stoi(words[1])) : 1;
    if (!test::example_case().there) return 77;
    const test::TemporaryFolder folder;
    test::PlayedSession how;
    how.seed = seed;
    how.updates = words.size() > 2 ? std::stoi(words[2]) : 90;
    test::record_session(how, test::example_case(), RecordMode::all, folder.path() / "devices.plrec");
    write_case(test::example_case().prepared, folder.path() / "case");
    Kills kills("/proc/self/exe", folder.path(), folder.path() / "devices.plrec", folder.path() / "case");
    fmt::print("A session lasts {:.1f} s.\n", kills.lasts_s());
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> share(0, 1);
    std::uniform_int_distribution<int> later_us(0, 30000);  // a frame takes about so long
    Sums sums;
    for (int i = 0; i < count; ++i) {
        kills.kill_one(i % 2 == 0 ? RecordMode::events : RecordMode::all, share(random),
                       std::chrono::microseconds(later_us(random)), sums);
        if ((i + 1) % 20 == 0) fmt::print(stderr, "{} of {}\n", i + 1, count);
    }
    print(sums, count);
    return sums.faults.empty() && sums.opened == count ? 0 : 1;
}
