// measure_disks [UPDATES] [SEED]: one session of the simulated paper's room is recorded with every frame, and then gone
// through again on its recorded devices, with the real recorder (--record all), on disks of every kind: one that is
// well, one that takes 0.1 s for each piece, one that stands still, one whose files may not be larger (RLIMIT_FSIZE),
// one that is full (a small tmpfs). Each in a program of its own. A table says of each how long the session's thread
// took for an update, how long of that the recorder kept it, what the person is told, and what of the recording is
// replayed to the last digit. The recorder may hold 20 MB here, so that there is something to be dropped. Exit code 0
// when every session was the recorded one to its end, said what it had lost, and left a recording that is alike as far
// as it goes.
#include <fmt/format.h>

#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "app/recording/recording_head.h"
#include "app/recording/replay_session.h"
#include "planning_io/case/case_folder.h"
#include "planning_io/types/error.h"
#include "tests/app/played_session.h"
#include "tests/support/test_data.h"

namespace {

using namespace planlight;
namespace fs = std::filesystem;
using namespace std::chrono_literals;
using std::chrono::steady_clock;

constexpr rlim_t kRoom = 10'000'000;
const std::vector<std::pair<std::string, std::string>> kDisks{{"none", "nothing is recorded"},
                                                              {"well", "a disk that is well"},
                                                              {"delayed", "0.1 s for each piece"},
                                                              {"still", "stands still"},
                                                              {"limited", "10 MB a file (RLIMIT_FSIZE)"},
                                                              {"full", "full after 10 MB (tmpfs)"}};

class SlowFile final : public RecordingSink {
public:
    SlowFile(const fs::path& file, std::chrono::milliseconds delay, const std::atomic<bool>& still)
        : file_(file), delay_(delay), still_(still) {}
    void append(std::string_view bytes) override {
        while (still_) std::this_thread::sleep_for(1ms);
        std::this_thread::sleep_for(delay_);
        file_.append(bytes);
    }
    void sync() override { file_.sync(); }

private:
    RecordingFile file_;
    std::chrono::milliseconds delay_;
    const std::atomic<bool>& still_;
};

/// Passes all to the recorder, and times it.
class Timed final : public SessionObserver {
public:
    explicit Timed(SessionRecorder* recorder) : recorder_(recorder) {}
    std::vector<double> update_ms, told_ms;  ///< of each update
    std::string trouble;                     ///< what a person was told last

    void room_entered(const RoomFacts& room) noexcept override { timed(&SessionRecorder::room_entered, room); }
    void asked(SessionCall call, const std::vector<PointPair>& landmarks, int which) noexcept override {
        timed(&SessionRecorder::asked, call, landmarks, which);
    }
    void clock_read(Instant now) noexcept override { timed(&SessionRecorder::clock_read, now); }
    void frame_exposed() noexcept override { timed(&SessionRecorder::frame_exposed); }
    void frame_taken(const StereoFrame& frame) noexcept override { timed(&SessionRecorder::frame_taken, frame); }
    void picture_shown(const RgbImage& picture, Instant valid_until, Instant lit_from) noexcept override {
        timed(&SessionRecorder::picture_shown, picture, valid_until, lit_from);
    }
    void went_dark() noexcept override { timed(&SessionRecorder::went_dark); }
    void cameras_doubted(const std::string& doubt) noexcept override {
        timed(&SessionRecorder::cameras_doubted, doubt);
    }
    void device_failed(const Error& fault) noexcept override { timed(&SessionRecorder::device_failed, fault); }
    void stopped(const Error& why) noexcept override { timed(&SessionRecorder::stopped, why); }
    void scanned(const Session& session) noexcept override { timed(&SessionRecorder::scanned, session); }
    void matched(const Session& session) noexcept override {
        timed(&SessionRecorder::matched, session);
        told_ = 0;
    }
    void updated(const Session& session, const Session::Update& update) noexcept override {
        timed(&SessionRecorder::updated, session, update);
        update_ms.push_back(1e3 * update.times.total_s() + told_);
        told_ms.push_back(std::exchange(told_, 0));
        if (recorder_) trouble = recorder_->trouble();
    }
    void skin_checked(const SkinCheck& check) noexcept override { timed(&SessionRecorder::skin_checked, check); }
    void refused(SessionCall call, const std::exception& why) noexcept override {
        timed(&SessionRecorder::refused, call, why);
    }
    void gate(GateCall call, Instant at, double off_mm, const LightGate::Ruling* ruling) noexcept override {
        timed(&SessionRecorder::gate, call, at, off_mm, ruling);
    }

private:
    template <class... Parameters, class... Arguments>
    void timed(void (SessionRecorder::*tell)(Parameters...) noexcept, const Arguments&... arguments) noexcept {
        if (!recorder_) return;
        const auto began = steady_clock::now();
        (recorder_->*tell)(arguments...);
        told_ += std::chrono::duration<double, std::milli>(steady_clock::now() - began).count();
    }
    SessionRecorder* recorder_;
    double told_ = 0;  ///< ms, since the last update
};

/// A file system of its own for this program, with so much room. False where that is not allowed.
bool mount_small(const fs::path& at) {
    const auto user = ::getuid();
    if (::unshare(CLONE_NEWNS) != 0) {
        if (::unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) return false;
        std::ofstream("/proc/self/uid_map") << "0 " << user << " 1";
    }
    if (::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) return false;
    return ::mount("none", at.c_str(), "tmpfs", 0, fmt::format("size={}", kRoom).c_str()) == 0;
}

std::string percentiles(std::vector<double> ms) {
    if (ms.empty()) return "-";
    std::sort(ms.begin(), ms.end());
    const auto at = [&](double share) {
        return ms[static_cast<std::size_t>(share * static_cast<double>(ms.size() - 1))];
    };
    return fmt::format("{:.2f}, {:.2f}, {:.2f}", at(0.5), at(0.99), ms.back());
}

/// Of the recording that is left: in words, and whether it is alike as far as it goes.
std::pair<std::string, bool> replayed(const fs::path& file, const Case& the_case) {
    if (!fs::exists(file) || fs::file_size(file) == 0) return {"empty", true};
    const ReplayResult result = replay_session(file, the_case);
    if (result.difference) return {"DIFFERS: " + result.difference->what, false};
    const char* const end = result.end == RecordingEnd::whole ? "to its end" : "to where it ends or lacks something";
    return {fmt::format("alike {}: {} scans, {} updates", end, result.scans, result.updates), true};
}

/// One disk, in this program: its row of the table.
int run_on(const std::string& kind, const fs::path& devices, const fs::path& case_folder, const fs::path& folder) {
    const std::string name = std::ranges::find(kDisks, kind, &std::pair<std::string, std::string>::first)->second;
    const Case the_case = read_case(case_folder);
    if (kind == "full" && !mount_small(folder)) {
        fmt::print("| {} | not allowed here: no file system of one's own | | | | |\n", name);
        return 0;
    }
    const fs::path file = folder / (kind + ".plrec");
    const rlimit limit{kRoom, kRoom};
    std::atomic<bool> still{kind == "still"};
    RecordingWriterSettings writing;
    writing.most_waiting_bytes = 20'000'000;
    writing.spare_bytes = 1'000'000;
    std::unique_ptr<SessionRecorder> recorder;
    if (kind != "none") {
        std::unique_ptr<RecordingSink> sink = std::make_unique<RecordingFile>(file);
        if (kind == "limited") ::setrlimit(RLIMIT_FSIZE, &limit);
        if (kind == "delayed" || kind == "still") {
            fs::remove(file);
            sink = std::make_unique<SlowFile>(file, kind == "delayed" ? 100ms : 0ms, still);
        }
        recorder = std::make_unique<SessionRecorder>(
            std::move(sink), recording_head(the_case, case_folder, RecordMode::all, {}), writing);
    }
    Timed timed(recorder.get());
    const ReplayResult session = replay_session(devices, the_case, {}, &timed);
    still = false;
    std::string lacks = recorder ? recorder->finish() : "";
    const RecordingState state = recorder ? recorder->state() : RecordingState{};
    recorder.reset();
    const auto [words, alike] = kind == "none" ? std::pair(std::string("-"), true) : replayed(file, the_case);
    const bool same = !session.difference && session.ended.empty();
    const bool said = state.dropped_chunks == 0 || (!timed.trouble.empty() && !lacks.empty());
    fmt::print("| {} | {}{} | {} | {} | {} | {} | {} |\n", name, timed.update_ms.size(),
               same ? "" : ", ANOTHER SESSION", percentiles(timed.update_ms), percentiles(timed.told_ms),
               state.dropped_chunks, timed.trouble.empty() ? "-" : timed.trouble, words);
    return same && said && alike ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> words(argv + 1, argv + argc);
    if (words.size() == 5 && words[0] == "--on") return run_on(words[1], words[2], words[3], words[4]);
    if (!test::example_case().there) return 77;
    const test::TemporaryFolder folder;
    test::PlayedSession how;
    how.updates = words.empty() ? 150 : std::stoi(words[0]);
    how.seed = words.size() > 1 ? static_cast<unsigned>(std::stoi(words[1])) : 1;
    const fs::path devices = folder.path() / "devices.plrec", case_folder = folder.path() / "case";
    test::record_session(how, test::example_case(), RecordMode::all, devices);
    write_case(test::example_case().prepared, case_folder);
    fmt::print(
        "| disk | updates | an update: median, 99 %, worst ms | of it the recorder: the same | pieces dropped | what "
        "is "
        "said | the recording is replayed |\n|---|---|---|---|---|---|---|\n");
    int bad = 0;
    for (const auto& [kind, name] : kDisks) {
        std::fflush(stdout);
        const fs::path own = folder.path() / kind;
        fs::create_directory(own);
        const pid_t child = ::fork();
        if (child == 0) {
            ::execl("/proc/self/exe", argv[0], "--on", kind.c_str(), devices.c_str(), case_folder.c_str(), own.c_str(),
                    nullptr);
            ::_exit(127);
        }
        int status = 0;
        ::waitpid(child, &status, 0);
        bad += !WIFEXITED(status) || WEXITSTATUS(status) != 0;
    }
    fmt::print("{}\n", bad == 0 ? "The light was the same on every disk, and what was lost was said."
                                : fmt::format("{} OF {} DISKS FAILED", bad, kDisks.size()));
    return bad == 0 ? 0 : 1;
}
