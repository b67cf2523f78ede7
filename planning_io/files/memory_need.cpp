#include "planning_io/files/memory_need.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

/// The number after `name` in a file of lines "NAME NUMBER ...", as the kernel writes them; of an empty name the first
/// word.
std::optional<std::uint64_t> number_in(const std::string& file, const std::string& name) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        std::string first;
        std::uint64_t number = 0;
        if (!name.empty() && !(words >> first && first == name)) continue;
        if (words >> number) return number;
        if (name.empty()) return std::nullopt;  // "max"
    }
    return std::nullopt;
}

std::uint64_t less(std::uint64_t whole, std::uint64_t part) {
    return whole > part ? whole - part : 0;
}

std::uint64_t left_of_machine() {
    const auto available = number_in("/proc/meminfo", "MemAvailable:");
    if (!available) return kNoLimit;
    return 1024 * (*available + number_in("/proc/meminfo", "SwapFree:").value_or(0));
}

/// What pictures of files take is given back when memory is wanted.
std::uint64_t left_of_group(const std::string& folder) {
    const auto limit = number_in(folder + "/memory.max", ""), used = number_in(folder + "/memory.current", "");
    if (!limit || !used) return kNoLimit;
    const auto files = number_in(folder + "/memory.stat", "inactive_file").value_or(0) +
                       number_in(folder + "/memory.stat", "active_file").value_or(0);
    return less(*limit, less(*used, files));
}

/// The groups from this process's own up to the root.
std::uint64_t left_of_groups() {
    std::ifstream in("/proc/self/cgroup");
    std::string group;
    for (std::string line; std::getline(in, line);)
        if (line.starts_with("0::")) group = line.substr(3);
    std::uint64_t left = kNoLimit;
    for (;;) {
        left = std::min(left, left_of_group("/sys/fs/cgroup" + (group == "/" ? "" : group)));
        if (group.empty() || group == "/") return left;
        group.resize(group.find_last_of('/'));
    }
}

std::uint64_t left_of_own(__rlimit_resource_t what, std::uint64_t used) {
    rlimit limit{};
    if (getrlimit(what, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kNoLimit;
    return less(limit.rlim_cur, used);
}

}  // namespace

std::uint64_t free_memory_bytes() {
    const std::uint64_t page = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
    const std::uint64_t mapped = page * number_in("/proc/self/statm", "").value_or(0);
    const std::uint64_t data = 1024 * number_in("/proc/self/status", "VmData:").value_or(0);
    return std::min(
        {left_of_machine(), left_of_groups(), left_of_own(RLIMIT_AS, mapped), left_of_own(RLIMIT_DATA, data)});
}

std::uint64_t most_memory_used_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return 1024 * static_cast<std::uint64_t>(usage.ru_maxrss);
}

void check_memory(const std::string& doing, std::uint64_t need_bytes, const std::string& remedy) {
    const std::uint64_t free = free_memory_bytes();
    if (need_bytes <= free) return;
    throw Error(ExitCode::disk,
                fmt::format("{} needs about {} MiB of memory, and {} MiB are to be had", doing, (need_bytes >> 20) + 1,
                            free >> 20),
                remedy);
}

}  // namespace planlight
