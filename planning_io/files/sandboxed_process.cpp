#include "planning_io/files/sandboxed_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <new>
#include <utility>

#include "planning_io/files/memory_need.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr rlim_t kMaxMemoryBytes = rlim_t{4} << 30;
constexpr rlim_t kMaxAnswerBytes = rlim_t{8} << 30;
constexpr rlim_t kMaxOpenFiles = 4096;
constexpr const char* kCopyAgain = "Copy or export it again from where it came from.";

constexpr ExitCode kParsed = ExitCode::done;

void limit_this_process(const ChildLimits& limits) {
    rlim_t already = 0;  // of address space that the parent brought along
    if (std::FILE* status = std::fopen("/proc/self/statm", "r")) {
        unsigned long pages = 0;
        if (std::fscanf(status, "%lu", &pages) == 1) already = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
        std::fclose(status);
    }
    const auto limit = [](auto what, rlim_t value) {  // never more than the parent may have: root could take it
        rlimit of_parent{};
        if (getrlimit(what, &of_parent) == 0) value = std::min(value, of_parent.rlim_max);
        const rlimit both{value, value};
        setrlimit(what, &both);
    };
    limit(RLIMIT_AS, already + kMaxMemoryBytes);
    limit(RLIMIT_CPU, limits.processor_s);
    limit(RLIMIT_FSIZE, kMaxAnswerBytes);
    limit(RLIMIT_NOFILE, kMaxOpenFiles);
    limit(RLIMIT_CORE, 0);
    alarm(limits.wait_s);
    if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0) {  // the parsers' own chatter
        dup2(nowhere, STDERR_FILENO);
        dup2(nowhere, STDOUT_FILENO);
    }
}

[[noreturn]] void be_the_child(Parcel& parcel, const fs::path& file, const ChildLimits& limits,
                               const std::function<void(Parcel&)>& parse) {
    const std::uint64_t at_first = free_memory_bytes();  // without the limit that is set now
    limit_this_process(limits);
    const auto fail = [&](ExitCode code, const std::string& problem, const std::string& remedy) {
        parcel.empty();
        parcel.put(code);
        parcel.put(problem);
        parcel.put(remedy);
    };
    try {
        parcel.put(kParsed);
        parse(parcel);
    } catch (const Error& e) {
        fail(e.exit_code, e.what(), e.remedy);
    } catch (const std::bad_alloc&) {
        fail(at_first < kMaxMemoryBytes ? ExitCode::disk : ExitCode::input_refused,
             fmt::format("{}: needs more memory to be read than the {} MiB that it may have", file.string(),
                         std::min<std::uint64_t>(kMaxMemoryBytes, at_first) >> 20),
             limits.when_too_large);
    } catch (const std::exception& e) {
        fail(ExitCode::file_damaged, file.string() + ": cannot be read (" + e.what() + ")", kCopyAgain);
    }
    _exit(0);
}

/// Throws what the child's end means, if it did not end well.
void check_end(int status, const rusage& used, const fs::path& file, const ChildLimits& limits) {
    if (WIFSIGNALED(status)) {
        const int signal = WTERMSIG(status);
        const auto spent_s = used.ru_utime.tv_sec + used.ru_stime.tv_sec + 1;  // whole seconds, rounded up
        if (signal == SIGKILL && spent_s < static_cast<long>(limits.processor_s))
            throw DiskError(file,
                            fmt::format("the system ended its reading, as it does when memory is short; {} MiB were in "
                                        "use by then, and more is needed",
                                        used.ru_maxrss >> 10),
                            "Close other programs, or give a smaller file.");
        const bool slow = signal == SIGXCPU || signal == SIGKILL || signal == SIGALRM;
        if (slow) throw DamagedFileError(file, "took longer to read than a sound " + limits.what + " does", kCopyAgain);
        throw ParserCrash(
            file, "made the reader of a " + limits.what + " crash (signal " + std::to_string(signal) + ")", kCopyAgain);
    }
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        throw DamagedFileError(file, "could not be read to its end", kCopyAgain);
}

}  // namespace

Parcel::Parcel() : fd_(memfd_create("planlight-parcel", MFD_CLOEXEC)) {}
Parcel::~Parcel() {
    if (fd_ >= 0) close(fd_);
}
Parcel::Parcel(Parcel&& other) noexcept : fd_(std::exchange(other.fd_, -1)), left_(other.left_) {}

void Parcel::empty() {
    if (ftruncate(fd_, 0) != 0 || lseek(fd_, 0, SEEK_SET) != 0)
        throw std::runtime_error("the parcel cannot be emptied");
}

void Parcel::begin_reading() {
    struct stat status {};
    left_ = fstat(fd_, &status) == 0 && lseek(fd_, 0, SEEK_SET) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
}

void Parcel::write_all(const void* from, std::size_t bytes) {
    const auto* at = static_cast<const char*>(from);
    while (bytes > 0) {
        const ssize_t moved = write(fd_, at, bytes);
        if (moved < 0 && errno == EINTR) continue;
        if (moved < 0 && errno == EFBIG)
            throw DiskError("the limit on the size of files (ulimit -f)", "is too small for what is read",
                            "Raise it, and try again.");
        if (moved <= 0) throw std::bad_alloc();  // an unnamed file in memory
        at += moved, bytes -= static_cast<std::size_t>(moved);
    }
}

void Parcel::read_all(void* to, std::size_t bytes) {
    if (bytes > left_) throw std::out_of_range("parcel");
    auto* at = static_cast<char*>(to);
    while (bytes > 0) {
        const ssize_t moved = read(fd_, at, bytes);
        if (moved < 0 && errno == EINTR) continue;
        if (moved <= 0) throw std::out_of_range("parcel");
        at += moved, bytes -= static_cast<std::size_t>(moved), left_ -= static_cast<std::uint64_t>(moved);
    }
}

Parcel parse_in_child(const fs::path& file, const ChildLimits& limits, const std::function<void(Parcel&)>& parse) {
    Parcel parcel;
    const pid_t child = parcel.is_open() ? fork() : -1;
    if (child < 0)
        throw DiskError(file, "no child process could be started to read it", "Close other programs and try again.");
    if (child == 0) be_the_child(parcel, file, limits, parse);
    int status = 0;
    rusage used{};
    while (wait4(child, &status, 0, &used) < 0 && errno == EINTR) {
    }
    check_end(status, used, file, limits);
    parcel.begin_reading();
    if (parcel.left() < sizeof(ExitCode)) throw DamagedFileError(file, "could not be read to its end", kCopyAgain);
    const auto code = parcel.get<ExitCode>();
    if (code == kParsed) return parcel;
    const std::string problem = parcel.get_text(), remedy = parcel.get_text();
    if (code == ExitCode::input_refused) throw InputError({}, problem, remedy);
    if (code != ExitCode::file_damaged) throw Error(code, problem, remedy);
    const auto colon = problem.find(": ");  // the sentence begins with the file at fault
    if (colon == std::string::npos) throw DamagedFileError(file, problem, remedy);
    throw DamagedFileError(problem.substr(0, colon), problem.substr(colon + 2), remedy);
}

}  // namespace planlight
