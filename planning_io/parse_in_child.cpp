#include "planning_io/parse_in_child.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <new>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr rlim_t kMaxMemoryBytes = rlim_t{4} << 30;
constexpr rlim_t kMaxAnswerBytes = rlim_t{8} << 30;
constexpr rlim_t kMaxOpenFiles = 4096;
constexpr rlim_t kMinProcessor_s = 1, kMaxProcessor_s = 240;
constexpr std::uintmax_t kSlowestBytes_s = 1'000'000;  // every sound file is unpacked much faster
constexpr unsigned kMaxWait_s = 300;
constexpr std::uint64_t kMaxNotes = 100;
constexpr const char* kCopyAgain = "Copy or export it again from where it came from.";

enum class Outcome : std::uint32_t { volume, refused, damaged };

/// An unnamed file in memory through which the child hands over what it read.
class Channel {
public:
    Channel() : fd_(memfd_create("planlight-volume", MFD_CLOEXEC)) {}
    ~Channel() {
        if (fd_ >= 0) close(fd_);
    }
    Channel(const Channel&) = delete;
    Channel& operator=(const Channel&) = delete;
    bool good() const { return fd_ >= 0 && good_; }
    void rewind() { lseek(fd_, 0, SEEK_SET); }

    void put(const void* data, std::size_t bytes) { move(const_cast<void*>(data), bytes, true); }
    void get(void* data, std::size_t bytes) { move(data, bytes, false); }
    template <class T>
    void put_value(const T& value) {
        put(&value, sizeof value);
    }
    template <class T>
    T get_value() {
        T value{};
        get(&value, sizeof value);
        return value;
    }
    void put_text(const std::string& text) {
        put_value(static_cast<std::uint64_t>(text.size()));
        put(text.data(), text.size());
    }
    std::string get_text() {
        const auto size = get_value<std::uint64_t>();
        if (size > (1 << 20)) good_ = false;
        std::string text(good_ ? size : 0, '\0');
        get(text.data(), text.size());
        return text;
    }

private:
    void move(void* data, std::size_t bytes, bool out) {
        auto* at = static_cast<char*>(data);
        while (good_ && bytes > 0) {
            const ssize_t moved = out ? write(fd_, at, bytes) : read(fd_, at, bytes);
            if (moved < 0 && errno == EINTR) continue;
            if (moved <= 0)
                good_ = false;
            else
                at += moved, bytes -= static_cast<std::size_t>(moved);
        }
    }
    int fd_;
    bool good_ = true;
};

void put_volume(Channel& channel, const Volume& volume) {
    channel.put_value(Outcome::volume);
    channel.put_value(volume.size);
    const Eigen::Matrix4d matrix = volume.ct_from_voxel.matrix();
    channel.put(matrix.data(), sizeof(double) * 16);
    channel.put_value(volume.is_hu);
    channel.put_text(volume.modality);
    channel.put_text(volume.frame_of_reference_uid);
    channel.put_text(volume.source);
    channel.put_value(static_cast<std::uint64_t>(volume.notes.size()));
    for (const auto& note : volume.notes) channel.put_text(note);
    channel.put(volume.values.data(), volume.values.size() * sizeof(float));
}

Volume get_volume(Channel& channel) {
    Volume volume;
    volume.size = channel.get_value<std::array<int, 3>>();
    Eigen::Matrix4d matrix;
    channel.get(matrix.data(), sizeof(double) * 16);
    volume.ct_from_voxel.matrix() = matrix;
    volume.is_hu = channel.get_value<bool>();
    volume.modality = channel.get_text();
    volume.frame_of_reference_uid = channel.get_text();
    volume.source = channel.get_text();
    const auto notes = channel.get_value<std::uint64_t>();
    for (std::uint64_t n = 0; n < notes && n < kMaxNotes; ++n) volume.notes.push_back(channel.get_text());
    if (!channel.good()) return volume;
    volume.values.resize(volume.index(0, 0, volume.size[2]));
    channel.get(volume.values.data(), volume.values.size() * sizeof(float));
    return volume;
}

/// Processor time that a sound file or folder of this size does not need.
rlim_t processor_limit_s(const fs::path& path) {
    std::uintmax_t bytes = 0;
    std::error_code error;
    if (fs::is_regular_file(path, error)) bytes = fs::file_size(path, error);
    int files = 0;
    if (const fs::path folder = fs::is_directory(path, error) ? path : path.parent_path();
        fs::is_directory(folder, error))
        for (fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error), end;
             !error && entry != end && files < 100000; entry.increment(error))
            if (std::error_code ignored; entry->is_regular_file(ignored)) bytes += entry->file_size(ignored), ++files;
    return std::min(kMaxProcessor_s,
                    kMinProcessor_s + static_cast<rlim_t>(bytes / kSlowestBytes_s) + static_cast<rlim_t>(files / 500));
}

void limit_this_process(rlim_t processor_s) {
    rlim_t already = 0;  // pages of address space that the parent brought along
    if (std::FILE* status = std::fopen("/proc/self/statm", "r")) {
        unsigned long pages = 0;
        if (std::fscanf(status, "%lu", &pages) == 1) already = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
        std::fclose(status);
    }
    const auto limit = [](auto what, rlim_t value) {
        const rlimit both{value, value};
        setrlimit(what, &both);
    };
    limit(RLIMIT_AS, already + kMaxMemoryBytes);
    limit(RLIMIT_CPU, processor_s);
    limit(RLIMIT_FSIZE, kMaxAnswerBytes);
    limit(RLIMIT_NOFILE, kMaxOpenFiles);
    limit(RLIMIT_CORE, 0);
    alarm(kMaxWait_s);
    if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0) {  // the parsers' own chatter
        dup2(nowhere, STDERR_FILENO);
        dup2(nowhere, STDOUT_FILENO);
    }
}

[[noreturn]] void be_the_child(Channel& channel, const fs::path& path, const std::function<Volume()>& parse) {
    limit_this_process(processor_limit_s(path));
    const auto answer = [&](Outcome outcome, const std::string& problem, const std::string& remedy) {
        channel.put_value(outcome);
        channel.put_text(problem);
        channel.put_text(remedy);
    };
    try {
        put_volume(channel, parse());
    } catch (const Error& e) {
        answer(e.exit_code == ExitCode::file_damaged ? Outcome::damaged : Outcome::refused, e.what(), e.remedy);
    } catch (const std::bad_alloc&) {
        answer(Outcome::refused, path.string() + ": needs more than 4 GiB of memory",
               "Give one series, or resample it to larger voxels.");
    } catch (const std::exception& e) {
        answer(Outcome::damaged, path.string() + ": cannot be read (" + e.what() + ")", kCopyAgain);
    }
    _exit(channel.good() ? 0 : 1);
}

}  // namespace

Volume parse_in_child(const fs::path& path, const std::function<Volume()>& parse) {
    Channel channel;
    const pid_t child = channel.good() ? fork() : -1;
    if (child < 0)
        throw DiskError(path, "no child process could be started to read it", "Close other programs and try again.");
    if (child == 0) be_the_child(channel, path, parse);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (WIFSIGNALED(status)) {
        const int signal = WTERMSIG(status);
        const bool slow = signal == SIGXCPU || signal == SIGKILL || signal == SIGALRM;
        throw DamagedFileError(path,
                               slow ? "took longer to read than a sound file does"
                                    : "made its parser crash (signal " + std::to_string(signal) + ")",
                               kCopyAgain);
    }
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        throw DamagedFileError(path, "could not be read to its end", kCopyAgain);
    channel.rewind();
    const auto outcome = channel.get_value<Outcome>();
    if (outcome != Outcome::volume) {
        const std::string problem = channel.get_text(), remedy = channel.get_text();
        if (outcome == Outcome::refused) throw InputError({}, problem, remedy);
        const auto colon = problem.find(": ");  // the sentence begins with the file at fault
        if (colon == std::string::npos) throw DamagedFileError(path, problem, remedy);
        throw DamagedFileError(problem.substr(0, colon), problem.substr(colon + 2), remedy);
    }
    Volume volume = get_volume(channel);
    if (!channel.good()) throw DamagedFileError(path, "could not be read to its end", kCopyAgain);
    return volume;
}

}  // namespace planlight
