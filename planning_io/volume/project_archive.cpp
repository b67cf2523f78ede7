#include "planning_io/volume/project_archive.h"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>
#include <zlib.h>

#include <array>
#include <memory>
#include <vector>

#include "planning_io/files/byte_source.h"
#include "planning_io/files/memory_need.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxInflatedBytes = std::uint64_t{16} << 30;
constexpr const char* kTooLarge = "Close other programs, or resample the volume to larger voxels.";
constexpr const char* kCopyAgain = "Copy the project again from where it came from.";

/// Inflates through zlib, which checks gzip's CRC (libarchive's own gzip filter does not).
struct GzipStream {
    gzFile file = nullptr;
    std::vector<unsigned char> block = std::vector<unsigned char>(1 << 18);
    std::uint64_t total = 0;
    bool damaged = false;

    explicit GzipStream(const fs::path& path) : file(gzopen(path.c_str(), "rb")) {
        if (file) gzbuffer(file, 1 << 18);
    }
    GzipStream(const GzipStream&) = delete;
    GzipStream& operator=(const GzipStream&) = delete;
    ~GzipStream() {
        if (file) gzclose(file);
    }

    /// The number of bytes in `block`; 0 at the end, negative when the stream is damaged.
    la_ssize_t next() {
        const int got = gzread(file, block.data(), static_cast<unsigned>(block.size()));
        int code = Z_OK;
        gzerror(file, &code);
        if (got > 0) total += static_cast<std::uint64_t>(got);
        if (got < 0 || (code != Z_OK && code != Z_STREAM_END) || total > kMaxInflatedBytes) damaged = true;
        return damaged ? -1 : got;
    }
    static la_ssize_t read(archive*, void* self, const void** data) {
        auto& stream = *static_cast<GzipStream*>(self);
        *data = stream.block.data();
        return stream.next();
    }
};

std::string read_entry(archive* tar, archive_entry* entry, const fs::path& file, std::uint64_t max_bytes,
                       std::uint64_t memory_times) {
    const auto size = archive_entry_size(entry);
    if (size < 0 || static_cast<std::uint64_t>(size) > max_bytes)
        throw DamagedFileError(file,
                               "holds an entry of " + std::to_string(size) + " bytes, more than the " +
                                   std::to_string(max_bytes) + " allowed",
                               kCopyAgain);
    std::error_code error;
    const std::uint64_t stored = fs::file_size(file, error), bytes = static_cast<std::uint64_t>(size);
    if (error || bytes > stored * kMostInflation)  // the size in the header may be a lie
        throw DamagedFileError(file, "is cut or damaged", kCopyAgain);
    check_memory(fmt::format("{}: reading its {} MiB", file.string(), (bytes >> 20) + 1), memory_times * bytes,
                 kTooLarge);
    std::string content;
    content.reserve(bytes);
    std::array<char, 1 << 16> block{};
    la_ssize_t got = 0;
    while ((got = archive_read_data(tar, block.data(), block.size())) > 0)
        content.append(block.data(), static_cast<std::size_t>(got));
    if (got < 0 || content.size() != static_cast<std::size_t>(size))
        throw DamagedFileError(file, "is cut or damaged", kCopyAgain);
    return content;
}

}  // namespace

std::map<std::string, std::string> read_tar_entries(const fs::path& file,
                                                    const std::function<bool(const std::string&)>& wanted,
                                                    std::uint64_t memory_times, std::uint64_t max_entry_bytes) {
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored))
        throw InputError(file, "is not a readable file", "Check the name of the file.");
    GzipStream stream(file);
    if (!stream.file) throw InputError(file, "cannot be opened", "Check the permissions of the file.");
    const bool gzip = gzdirect(stream.file) == 0;
    const std::unique_ptr<archive, int (*)(archive*)> tar(archive_read_new(), archive_read_free);
    archive_read_support_format_tar(tar.get());
    std::map<std::string, std::string> entries;
    if (archive_read_open(tar.get(), &stream, nullptr, GzipStream::read, nullptr) != ARCHIVE_OK) stream.damaged = gzip;
    archive_entry* entry = nullptr;
    int status = ARCHIVE_OK, headers = 0;
    while (!stream.damaged && (status = archive_read_next_header(tar.get(), &entry)) == ARCHIVE_OK) {
        if (++headers > 100000) throw DamagedFileError(file, "holds more than 100000 entries", kCopyAgain);
        const char* path = archive_entry_pathname(entry);
        if (!path || archive_entry_filetype(entry) != AE_IFREG) continue;
        const std::string name = fs::path(path).filename().string();
        if (!wanted(name)) continue;
        if (!entries.emplace(name, read_entry(tar.get(), entry, file, max_entry_bytes, memory_times)).second)
            throw DamagedFileError(file, "holds " + name + " twice", kCopyAgain);
    }
    if (!stream.damaged && status == ARCHIVE_EOF)
        while (stream.next() > 0) {
        }
    if (stream.damaged || (status != ARCHIVE_EOF && (gzip || headers > 0)))
        throw DamagedFileError(file, "is cut or damaged", kCopyAgain);
    if (status != ARCHIVE_EOF || headers == 0)
        throw InputError(file, "is not an archive of the kind an InVesalius project is (gzip tar)",
                         "Name a project that InVesalius 3 saved (.inv3).");
    return entries;
}

}  // namespace planlight
