#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

namespace planlight {

/// Bytes of a file anywhere in it. Who goes on reads in larger and larger pieces, so that small neighbours cost no call
/// of the system each; who jumps, from header to header over an hour's pictures, reads little at each place.
class FileWindow {
public:
    /// `opened` says whether it worked.
    explicit FileWindow(const std::filesystem::path& file);
    ~FileWindow();
    FileWindow(const FileWindow&) = delete;
    FileWindow& operator=(const FileWindow&) = delete;
    bool opened() const { return file_ >= 0; }

    /// As many of these bytes as the file has, until the next call; fewer where it ends, or where the disk does not
    /// give them (`failed`).
    std::string_view bytes(std::uint64_t at, std::size_t count);
    bool failed() const { return failed_; }             ///< of the last call
    std::uint64_t bytes_read() const { return read_; }  ///< from the disk, all in all

private:
    std::size_t read(std::uint64_t at, char* to, std::size_t count);
    int file_ = -1;
    bool failed_ = false;
    std::vector<char> window_;
    std::uint64_t from_ = 0;  ///< place of the window in the file
    std::size_t filled_ = 0;
    std::size_t piece_ = 0;  ///< was to be read last
    std::uint64_t read_ = 0;
};

}  // namespace planlight
