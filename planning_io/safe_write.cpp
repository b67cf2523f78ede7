#include "planning_io/safe_write.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <random>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDiskRemedy = "Check the free space and the permissions of the folder, then write again.";

[[noreturn]] void refuse(const fs::path& file, const std::string& doing) {
    const int code = errno;
    throw DiskError(file, doing + (code ? std::string(": ") + std::strerror(code) : std::string()), kDiskRemedy);
}

/// A new empty file beside `file`, with the permissions that the user's umask gives.
fs::path make_temporary_beside(const fs::path& file) {
    std::random_device random;
    for (int attempt = 0; attempt < 100; ++attempt) {
        fs::path temporary = file;
        temporary += ".part-" + std::to_string(random());
        const int fd = ::open(temporary.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
        if (fd >= 0) {
            ::close(fd);
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

struct RemoveUnlessKept {
    fs::path path;
    bool kept = false;
    ~RemoveUnlessKept() {
        if (!kept) ::unlink(path.c_str());
    }
};

}  // namespace

void write_safely(const fs::path& file, const std::function<void(std::ostream&)>& write) {
    RemoveUnlessKept temporary{make_temporary_beside(file)};
    {
        std::ofstream out(temporary.path, std::ios::binary | std::ios::trunc);
        errno = 0;
        if (out) write(out);
        out.close();
        if (!out) refuse(file, "cannot be written");
    }
    sync(temporary.path, file);
    if (::rename(temporary.path.c_str(), file.c_str()) != 0) refuse(file, "cannot be put in place");
    temporary.kept = true;
    sync(file.has_parent_path() ? file.parent_path() : fs::path("."), file);
}

void write_safely(const fs::path& file, const std::string& content) {
    write_safely(file, [&](std::ostream& out) { out.write(content.data(), static_cast<std::streamsize>(content.size())); });
}

std::string read_whole(const fs::path& file) {
    std::error_code ignored;
    const auto status = fs::status(file, ignored);
    if (!fs::exists(status)) throw InputError(file, "does not exist", "Check the name of the file.");
    if (fs::is_directory(status)) throw InputError(file, "is a folder, not a file", "Name the file itself.");
    std::ifstream in(file, std::ios::binary);
    std::string content;
    const auto size = fs::file_size(file, ignored);
    if (!ignored) content.reserve(size);
    std::array<char, 1 << 16> block{};
    while (in.read(block.data(), block.size()) || in.gcount() > 0) content.append(block.data(), static_cast<std::size_t>(in.gcount()));
    if (!in.eof()) throw InputError(file, "cannot be read", "Check the permissions of the file and the disk it is on.");
    return content;
}

}  // namespace planlight
