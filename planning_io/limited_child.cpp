#include "planning_io/limited_child.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <new>
#include <stdexcept>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr rlim_t kMaxMemoryBytes = rlim_t{4} << 30;
constexpr rlim_t kMaxProcessor_s = 30;
constexpr unsigned kMaxWait_s = 120;
constexpr const char* kCopyAgain = "Copy or export the file again.";

enum class Outcome : std::uint32_t { parsed, refused, damaged };

/// Closes the unnamed file through which the child hands over its parcel.
struct Channel {
    int fd = memfd_create("planlight-parcel", MFD_CLOEXEC);
    Channel() = default;
    ~Channel() {
        if (fd >= 0) close(fd);
    }
    Channel(const Channel&) = delete;
    Channel& operator=(const Channel&) = delete;
};

bool write_all(int fd, const std::string& bytes) {
    for (std::size_t done = 0; done < bytes.size();) {
        const ssize_t moved = write(fd, bytes.data() + done, bytes.size() - done);
        if (moved < 0 && errno == EINTR) continue;
        if (moved <= 0) return false;
        done += static_cast<std::size_t>(moved);
    }
    return true;
}

bool read_all(int fd, std::string& bytes) {
    struct stat status {};
    if (fstat(fd, &status) != 0) return false;
    bytes.resize(static_cast<std::size_t>(status.st_size));
    for (std::size_t done = 0; done < bytes.size();) {
        const ssize_t moved = pread(fd, bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
        if (moved < 0 && errno == EINTR) continue;
        if (moved <= 0) return false;
        done += static_cast<std::size_t>(moved);
    }
    return true;
}

void limit_this_process() {
    rlim_t already = 0;  // of address space that the parent brought along
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
    limit(RLIMIT_CPU, kMaxProcessor_s);
    limit(RLIMIT_CORE, 0);
    alarm(kMaxWait_s);
    if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0) {  // the parsers' own chatter
        dup2(nowhere, STDERR_FILENO);
        dup2(nowhere, STDOUT_FILENO);
    }
}

[[noreturn]] void be_the_child(int fd, const fs::path& file, const std::function<void(Parcel&)>& parse) {
    limit_this_process();
    Parcel parcel;
    const auto fail = [&](Outcome outcome, const std::string& problem, const std::string& remedy) {
        parcel = Parcel();
        parcel.put(outcome);
        parcel.put(problem);
        parcel.put(remedy);
    };
    try {
        parcel.put(Outcome::parsed);
        parse(parcel);
    } catch (const Error& e) {
        fail(e.exit_code == ExitCode::file_damaged ? Outcome::damaged : Outcome::refused, e.what(), e.remedy);
    } catch (const std::bad_alloc&) {
        fail(Outcome::damaged, file.string() + ": needs more than 4 GiB of memory", kCopyAgain);
    } catch (const std::exception& e) {
        fail(Outcome::damaged, file.string() + ": cannot be read (" + e.what() + ")", kCopyAgain);
    }
    _exit(write_all(fd, parcel.bytes()) ? 0 : 1);
}

}  // namespace

void Parcel::take(void* to, std::size_t count) {
    if (count > bytes_.size() - at_) throw std::out_of_range("parcel");
    std::memcpy(to, bytes_.data() + at_, count);
    at_ += count;
}

Parcel parse_in_child(const fs::path& file, const std::string& what, const std::function<void(Parcel&)>& parse) {
    const Channel channel;
    const pid_t child = channel.fd >= 0 ? fork() : -1;
    if (child < 0) throw DiskError(file, "no child process could be started to read it", "Close other programs and try again.");
    if (child == 0) be_the_child(channel.fd, file, parse);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (WIFSIGNALED(status)) {
        const int signal = WTERMSIG(status);
        const bool slow = signal == SIGXCPU || signal == SIGKILL || signal == SIGALRM;
        throw DamagedFileError(file,
                               slow ? "took longer to read than a sound " + what + " does"
                                    : "made the reader of a " + what + " crash (signal " + std::to_string(signal) + ")",
                               kCopyAgain);
    }
    std::string bytes;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || !read_all(channel.fd, bytes) || bytes.size() < sizeof(Outcome))
        throw DamagedFileError(file, "could not be read to its end", kCopyAgain);
    Parcel parcel(std::move(bytes));
    const auto outcome = parcel.get<Outcome>();
    if (outcome == Outcome::parsed) return parcel;
    const std::string problem = parcel.get_text(), remedy = parcel.get_text();
    if (outcome == Outcome::refused) throw InputError({}, problem, remedy);
    const auto colon = problem.find(": ");  // the sentence begins with the file at fault
    if (colon == std::string::npos) throw DamagedFileError(file, problem, remedy);
    throw DamagedFileError(problem.substr(0, colon), problem.substr(colon + 2), remedy);
}

}  // namespace planlight
