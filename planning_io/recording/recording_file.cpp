#include "planning_io/recording/recording_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include "planning_io/files/checked_chunks.h"
#include "planning_io/files/disk_refusal.h"
#include "planning_io/recording/recording_chunk.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

std::uint32_t crc_of(std::string_view a, std::string_view b = {}) {
    const auto* first = reinterpret_cast<const Bytef*>(a.data());
    const auto* second = reinterpret_cast<const Bytef*>(b.data());
    uLong crc = crc32_z(0, first, a.size());
    if (!b.empty()) crc = crc32_z(crc, second, b.size());
    return static_cast<std::uint32_t>(crc);
}

[[noreturn]] void refuse(const fs::path& file, const std::string& doing) {
    const int code = errno;
    const bool no_room = code == ENOSPC || code == EDQUOT || code == EFBIG;
    throw DiskRefusal(file, doing + ": " + std::strerror(code),
                      std::string(no_room ? "Make room on the disk" : "Look at the folder and its permissions") +
                          ", name another folder with `planlight session --recordings`, or do without: "
                          "`planlight session --record none`.",
                      std::error_code(code, std::generic_category()));
}

/// The names in a folder are on the disk afterwards: without that a power cut may leave a file's bytes and no name.
void sync_folder(const fs::path& folder) {
    const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return;  // one that may be written and not read: nothing more can be done
    const int failed = ::fsync(descriptor), code = errno;
    ::close(descriptor);
    errno = code;
    const bool unknown_there = code == EINVAL || code == ENOTSUP || code == ENOSYS;  // some shares cannot
    if (failed != 0 && !unknown_there) refuse(folder, "cannot be synced to the disk");
}

/// The folder is for its owner only; one that is there already stays as it is.
void make_folder(const fs::path& folder) {
    std::error_code unknown;  // without permission to look, `mkdir` says why
    if (folder.empty() || fs::is_directory(folder, unknown)) return;
    if (folder.has_parent_path() && folder.parent_path() != folder) make_folder(folder.parent_path());
    if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) refuse(folder, "cannot be made");
    sync_folder(folder.parent_path());
}

/// A limit on the size of files is told by an error code, not by a signal that ends the program in the middle of an
/// operation.
void ignore_size_signal() {
    struct sigaction now {};
    if (::sigaction(SIGXFSZ, nullptr, &now) == 0 && now.sa_handler == SIG_DFL) std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace

std::string recording_header() {
    FieldWriter header;
    for (const char c : std::string_view("PLRECORD")) header.add(c);
    header.add(kRecordingVersion);
    header.add(crc_of(header.bytes()));
    return header.bytes();
}

std::string chunk_bytes(const RecordingChunk& chunk, std::uint64_t number) {
    if (chunk.payload.size() > kMostPayloadBytes) throw std::length_error("chunk_bytes: a payload beyond the limit");
    FieldWriter header;
    for (const char c : std::string_view("CHNK")) header.add(c);
    for (const char c : chunk.type) header.add(c);
    header.add(number);
    header.add(static_cast<std::int64_t>(chunk.at.count()));
    header.add(static_cast<std::uint32_t>(chunk.payload.size()));
    header.add(crc_of(header.bytes(), chunk.payload));
    return header.bytes() + chunk.payload;
}

RecordingFile::RecordingFile(const fs::path& file) : file_(file) {
    make_folder(file.parent_path());
    ignore_size_signal();
    descriptor_ = ::open(file.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (descriptor_ < 0) refuse(file, "cannot be written");
    try {
        sync_folder(file.parent_path());
    } catch (...) {
        ::close(descriptor_);
        throw;
    }
}

RecordingFile::~RecordingFile() {
    ::close(descriptor_);
}

void RecordingFile::append(std::string_view bytes) {
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t written =
            ::pwrite(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(bytes_ + done));
        if (written > 0) {
            done += static_cast<std::size_t>(written);
            continue;
        }
        if (written < 0 && errno == EINTR) continue;
        const int code = written == 0 ? ENOSPC : errno;
        static_cast<void>(::ftruncate(descriptor_, static_cast<off_t>(bytes_)) == 0);
        errno = code;
        refuse(file_, "cannot be written");
    }
    bytes_ += bytes.size();
}

void RecordingFile::sync() {
    if (::fdatasync(descriptor_) != 0 && errno != EINVAL) refuse(file_, "cannot be synced to the disk");
}

}  // namespace planlight
