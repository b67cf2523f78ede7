#include "planning_io/files/safe_write.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <random>

#include "planning_io/files/check_exists.h"
#include "planning_io/files/disk_refusal.h"
#include "planning_io/files/held_end_signals.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, const std::string& doing) {
    const int code = errno;
    std::error_code ignored;
    if (code == ENOENT && !fs::exists(file.has_parent_path() ? file.parent_path() : fs::path("."), ignored))
        throw DiskError(file, doing + ": its folder does not exist",
                        "Make the folder " + file.parent_path().string() + " first.");
    const std::error_code why(code, std::generic_category());
    throw DiskRefusal(file, doing + (code ? std::string(": ") + std::strerror(code) : std::string()),
                      remedy_of_unwritable(why), why);
}

/// A new empty file (or folder) beside `file`, with those of the permissions `mode` that the user's umask gives.
fs::path make_temporary_beside(const fs::path& file, bool folder = false, mode_t mode = 0666) {
    std::random_device random;
    for (int attempt = 0; attempt < 100; ++attempt) {
        fs::path temporary = file;
        temporary += ".part-" + std::to_string(random());
        const int made = folder ? ::mkdir(temporary.c_str(), 0777)
                                : ::open(temporary.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, mode);
        if (made >= 0) {
            if (!folder) ::close(made);
            return temporary;
        }
        if (errno != EEXIST) refuse(file, "cannot be written");
    }
    refuse(file, "cannot be written, no free temporary name");
}

void sync(const fs::path& path, const fs::path& file) {
    const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0) refuse(file, "cannot be opened for syncing");
    const int failed = ::fsync(fd);
    const int code = errno;
    ::close(fd);
    errno = code;
    if (failed && code != EINVAL) refuse(file, "cannot be synced to the disk");
}

void write_into(const fs::path& path, const fs::path& file, const std::function<void(std::ostream&)>& write) {
    std::ofstream out(path, std::ios::binary | std::ios::trunc);
    errno = 0;
    if (out) write(out);
    out.close();
    if (!out) refuse(file, "cannot be written");
}

/// A disk that knows no permissions (FAT, some shares) gives a file to everybody, whatever it is asked.
void check_owner_only(const fs::path& path, const fs::path& file) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) refuse(file, "cannot be written");
    if ((status.st_mode & 0077) == 0) return;
    throw DiskError(file, "cannot be kept from others: this disk gives it to everybody on the computer",
                    "Name a folder on a disk that knows permissions.");
}

/// Within a folder that is being filled: the rest is not written, and the signal ends the program once that is removed.
void stop_where_a_signal_waits(const fs::path& file) {
    if (HeldEndSignals::one_waits())
        throw DiskError(file, "was not written: the program was told to end", "Start anew.");
}

struct RemoveUnlessKept {
    fs::path path;
    bool kept = false;
    ~RemoveUnlessKept() {
        if (!kept) ::unlink(path.c_str());
    }
};

/// Removes what is left there: the half-written folder, or the old one after an exchange.
struct RemoveFolder {
    fs::path path;
    ~RemoveFolder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
};

/// The folder that is meant: "case/" means "case", a link the folder that it leads to.
fs::path meant_folder(const fs::path& folder) {
    fs::path target = folder;
    if (!target.has_filename()) target = target.parent_path();
    std::error_code fault, ignored;
    if (fs::exists(target, fault)) return fs::canonical(target);
    if (fault) {
        errno = fault.value();
        refuse(folder, "cannot be written");
    }
    if (fs::is_symlink(target, ignored))
        throw InputError(target, "is a link to a folder that is not there", "Make that folder, or name another.");
    return target;
}

}  // namespace

void write_safely(const fs::path& file_or_link, const std::function<void(std::ostream&)>& write,
                  ReadableBy readable_by) {
    std::error_code ignored;
    const fs::path file =
        fs::is_symlink(file_or_link, ignored) ? fs::weakly_canonical(file_or_link, ignored) : file_or_link;
    if (fs::exists(file, ignored) && !fs::is_regular_file(file, ignored)) {
        if (fs::is_directory(file, ignored)) throw DiskError(file, "is a folder, not a file", "Name a file.");
        return write_into(file, file, write);  // a pipe or a device is written to, never replaced
    }
    const bool owner_only = readable_by == ReadableBy::owner;
    const HeldEndSignals until_nothing_is_left;
    stop_where_a_signal_waits(file);
    RemoveUnlessKept temporary{make_temporary_beside(file, false, owner_only ? 0600 : 0666)};
    if (owner_only) check_owner_only(temporary.path, file);
    write_into(temporary.path, file, write);
    sync(temporary.path, file);
    if (::rename(temporary.path.c_str(), file.c_str()) != 0) refuse(file, "cannot be put in place");
    temporary.kept = true;
    sync(file.has_parent_path() ? file.parent_path() : fs::path("."), file);
}

void write_safely(const fs::path& file, const std::string& content, ReadableBy readable_by) {
    write_safely(
        file, [&](std::ostream& out) { out.write(content.data(), static_cast<std::streamsize>(content.size())); },
        readable_by);
}

void check_can_write(const fs::path& file) {
    std::error_code ignored;
    if (fs::is_directory(file, ignored)) throw DiskError(file, "is a folder, not a file", "Name a file.");
    if (fs::exists(file, ignored) && !fs::is_regular_file(file, ignored)) return;
    RemoveUnlessKept{make_temporary_beside(fs::is_symlink(file, ignored) ? fs::weakly_canonical(file, ignored) : file)};
}

void check_new_folder(const fs::path& folder) {
    const fs::path target = meant_folder(folder);
    RemoveFolder{make_temporary_beside(target, true)};
}

void write_folder_safely(const fs::path& folder, bool replace, const std::function<void(const fs::path&)>& fill) {
    const fs::path target = meant_folder(folder);
    const bool there = fs::exists(target), empty = there && fs::is_directory(target) && fs::is_empty(target);
    if (there && !fs::is_directory(target)) throw InputError(target, "is a file, not a folder", "Name another folder.");
    if (there && !empty && !replace)
        throw InputError(target, "exists already and is not empty", "Name a new folder, or empty this one.");
    const HeldEndSignals until_nothing_is_left;
    RemoveFolder temporary{make_temporary_beside(target, true)};
    fill(temporary.path);
    sync(temporary.path, target);
    const bool exchange = there && !empty;
    if (::renameat2(AT_FDCWD, temporary.path.c_str(), AT_FDCWD, target.c_str(), exchange ? RENAME_EXCHANGE : 0) != 0) {
        if (!exchange || (errno != EINVAL && errno != ENOSYS)) refuse(target, "cannot be put in place");
        RemoveFolder old{make_temporary_beside(target, true)};  // a file system that cannot exchange: two steps
        if (::rename(target.c_str(), old.path.c_str()) != 0) refuse(target, "cannot be put in place");
        if (::rename(temporary.path.c_str(), target.c_str()) != 0) {
            ::rename(old.path.c_str(), target.c_str());
            refuse(target, "cannot be put in place");
        }
    }
    sync(target.has_parent_path() ? target.parent_path() : fs::path("."), target);
}

std::string read_whole(const fs::path& file) {
    check_exists(file);
    std::error_code ignored;
    const auto status = fs::status(file, ignored);
    if (fs::is_directory(status)) throw InputError(file, "is a folder, not a file", "Name the file itself.");
    if (!fs::is_regular_file(status))
        throw InputError(file, "is a pipe or a device, not a file", "Copy its content to a file.");
    std::ifstream in(file, std::ios::binary);
    std::string content;
    const auto size = fs::file_size(file, ignored);
    if (!ignored) content.reserve(size);
    std::array<char, 1 << 16> block{};
    while (in.read(block.data(), block.size()) || in.gcount() > 0)
        content.append(block.data(), static_cast<std::size_t>(in.gcount()));
    if (!in.eof()) throw InputError(file, "cannot be read", "Check the permissions of the file and the disk it is on.");
    return content;
}

}  // namespace planlight
