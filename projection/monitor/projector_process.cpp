#include "projection/monitor/projector_process.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "planning_io/types/error.h"

extern char** environ;

namespace planlight {
namespace {

constexpr auto kPoll = std::chrono::milliseconds(1);

/// Processes that were killed and have not gone: they hang in the graphics driver, and their windows may stay lit. Of
/// all `ProjectorProcess` of the program.
class Unended {
public:
    static Unended& all() {
        static Unended unended;
        return unended;
    }
    void add(pid_t process) {
        const std::lock_guard lock(mutex_);
        processes_.push_back(process);
    }
    bool any() {
        const std::lock_guard lock(mutex_);
        std::erase_if(processes_, [](pid_t process) { return waitpid(process, nullptr, WNOHANG) != 0; });
        return !processes_.empty();
    }

private:
    std::mutex mutex_;
    std::vector<pid_t> processes_;
};

UnendedProjector cannot_be_ended() {
    return UnendedProjector(
        "Projector process", "it cannot be ended, and its light may still be on",
        "Switch the projector off by hand. Its process hangs in the graphics driver: restart the computer.");
}

/// Starts `PROGRAM projector-window --monitor M` with the two descriptors and nothing else of ours open, in a process
/// group of its own: Ctrl-Z in the terminal must not stop both sides at once, for nobody would be left to make it dark.
pid_t spawn(const std::filesystem::path& program, const std::string& monitor, int bell, int mailbox) {
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    // Through high numbers first: 3 and 4 may be the very descriptors that are to be copied.
    const int bell_copy = fcntl(bell, F_DUPFD_CLOEXEC, 100), mailbox_copy = fcntl(mailbox, F_DUPFD_CLOEXEC, 100);
    posix_spawn_file_actions_adddup2(&files, bell_copy, kProjectorBell);
    posix_spawn_file_actions_adddup2(&files, mailbox_copy, kProjectorMailbox);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    posix_spawnattr_setpgroup(&attributes, 0);
    const std::string executable = program.string();
    std::array<std::string, 4> words{executable, "projector-window", "--monitor", monitor};
    std::array<char*, 5> arguments{words[0].data(), words[1].data(), words[2].data(), words[3].data(), nullptr};
    pid_t process = -1;
    const int failed = posix_spawn(&process, executable.c_str(), &files, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    close(bell_copy);
    close(mailbox_copy);
    if (failed != 0)
        throw DeviceError("Projector process", std::string("it cannot be started: ") + std::strerror(failed),
                          "Check the installation, and free memory.");
    return process;
}

}  // namespace

bool a_projector_process_hangs() {
    return Unended::all().any();
}

ProjectorProcess::ProjectorProcess(const std::string& monitor, const ProjectorProcessSettings& settings)
    : settings_(settings), monitor_(monitor) {
    if (Unended::all().any()) throw cannot_be_ended();
    start(monitor);
    try {
        wait_until_ready();
    } catch (...) {
        end();
        throw;
    }
}

ProjectorProcess::~ProjectorProcess() {
    go_dark();
    end();
}

void ProjectorProcess::start(const std::string& monitor) {
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
        throw DeviceError("Projector process", std::strerror(errno), "Close other programs and try again.");
    bell_ = ends[0];
    try {
        process_ = spawn(settings_.program, monitor, ends[1], mailbox_.descriptor());
    } catch (...) {
        close(ends[1]);
        end();
        throw;
    }
    close(ends[1]);
}

void ProjectorProcess::wait_until_ready() {
    const Instant until = clock_.now() + settings_.start_allowed;
    while (mailbox_.state() == LightMailbox::State::starting) {
        if (waitpid(process_, nullptr, WNOHANG) != 0) {
            process_ = -1;
            if (mailbox_.state() == LightMailbox::State::failed) break;  // it had said why
            throw DeviceError("Projector process", "it ended while it started",
                              "Update the graphics driver, or set LIBGL_ALWAYS_SOFTWARE=1.");
        }
        if (clock_.now() > until)
            throw DeviceError("Projector process", "its window did not open in time",
                              "Update the graphics driver, or set LIBGL_ALWAYS_SOFTWARE=1.");
        std::this_thread::sleep_for(kPoll);
    }
    if (mailbox_.state() == LightMailbox::State::failed) fail(mailbox_.problem(), mailbox_.remedy());
    width_ = mailbox_.width();
    height_ = mailbox_.height();
    if (const std::string name = mailbox_.monitor(); !name.empty()) monitor_ = name;
}

void ProjectorProcess::fail(const std::string& problem, const std::string& remedy) {
    if (!end()) throw cannot_be_ended();
    // The process names its device itself.
    const std::size_t colon = problem.find(": ");
    if (colon == std::string::npos) throw DeviceError("Projector", problem, remedy);
    throw DeviceError(problem.substr(0, colon), problem.substr(colon + 2), remedy);
}

bool ProjectorProcess::end() noexcept {
    constexpr Instant kPatience = std::chrono::milliseconds(300);
    if (bell_ >= 0) close(bell_);
    bell_ = -1;
    if (process_ < 0) return true;
    // Killed, not asked: the window goes with the process, also when that was stopped.
    const pid_t process = std::exchange(process_, -1);
    kill(process, SIGKILL);
    for (const Instant until = clock_.now() + kPatience; clock_.now() < until; std::this_thread::sleep_for(kPoll))
        if (waitpid(process, nullptr, WNOHANG) != 0) return true;
    Unended::all().add(process);
    unended_ = true;
    return false;
}

void ProjectorProcess::wake() {
    const char byte = 1;
    static_cast<void>(send(bell_, &byte, 1, MSG_NOSIGNAL | MSG_DONTWAIT));
}

void ProjectorProcess::renew() {
    mailbox_.renew_lease(clock_.now() + settings_.lease);
}

void ProjectorProcess::check() {
    const std::lock_guard lock(mutex_);
    check_locked();
}

void ProjectorProcess::check_locked() {
    if (process_ < 0) throw_ended("it has ended");
    if (mailbox_.state() == LightMailbox::State::failed) fail(mailbox_.problem(), mailbox_.remedy());
    if (waitpid(process_, nullptr, WNOHANG) != 0) {  // also where the program that started us reaps its children itself
        process_ = -1;
        end();
        throw_ended("it was ended from outside, or crashed");
    }
    const Instant busy_since = mailbox_.busy_since();
    if (clock_.now() - mailbox_.alive_at() > settings_.silence_allowed ||
        (busy_since.count() > 0 && clock_.now() - busy_since > settings_.work_allowed)) {
        end();
        throw_ended("it does not answer any more");
    }
}

void ProjectorProcess::throw_ended(const std::string& problem) {
    if (unended_) throw cannot_be_ended();
    throw DeviceError("Projector process", problem,
                      "The light is dark. It can be started again; if this comes back, restart the computer.");
}

void ProjectorProcess::wait_until_done(std::uint64_t number, const std::function<void()>& meanwhile) {
    while (mailbox_.done() < number) {
        check_locked();
        meanwhile();
        std::this_thread::sleep_for(kPoll);
    }
}

Instant ProjectorProcess::show(const RgbImage& picture, Instant valid_until, const std::function<bool()>& permitted) {
    const std::lock_guard lock(mutex_);
    check_locked();
    if (picture.width != width_ || picture.height != height_) {
        mailbox_.order({}, {});
        wake();
        throw DeviceError("Projector window",
                          "a picture of " + std::to_string(picture.width) + "x" + std::to_string(picture.height) +
                              " does not fit the monitor's " + std::to_string(width_) + "x" + std::to_string(height_),
                          "Calibrate the rig at the projector's own resolution, or set the monitor to it.");
    }
    const std::uint64_t number = mailbox_.order(picture, valid_until);
    wake();
    wait_until_done(number, [&] {
        if (!permitted || permitted()) renew();
    });
    return mailbox_.done_at() + settings_.light_delay;
}

void ProjectorProcess::go_dark() noexcept {
    const std::lock_guard lock(mutex_);
    mailbox_.renew_lease({});
    if (process_ < 0) return;
    const std::uint64_t number = mailbox_.order({}, {});
    wake();
    try {
        wait_until_done(number, [] {});
    } catch (const std::exception&) {
        // The process is ended then, and dark; the next `check` says where it is not.
    }
}

}  // namespace planlight
