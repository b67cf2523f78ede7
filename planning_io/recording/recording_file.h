#pragma once

#include <filesystem>
#include <string_view>

namespace planlight {

/// Where the bytes of a recording go: a file, or what a test puts in its place.
class RecordingSink {
public:
    virtual ~RecordingSink() = default;
    /// Adds all of these bytes or none of them. Throws DiskError.
    virtual void append(std::string_view bytes) = 0;
    /// What was added is on the disk afterwards. Throws DiskError.
    virtual void sync() = 0;
};

/// A file that only grows, readable and writable by its owner alone (0600).
class RecordingFile final : public RecordingSink {
public:
    /// Makes the file and, where it is missing, its folder (0700); their names are on the disk afterwards. Throws
    /// DiskError when it is there already or cannot be made.
    explicit RecordingFile(const std::filesystem::path& file);
    ~RecordingFile() override;
    RecordingFile(const RecordingFile&) = delete;
    RecordingFile& operator=(const RecordingFile&) = delete;

    /// What a full disk took only a part of is taken back, so that the file always ends with a whole chunk.
    void append(std::string_view bytes) override;
    void sync() override;

private:
    std::filesystem::path file_;
    int descriptor_ = -1;
    std::size_t bytes_ = 0;
};

}  // namespace planlight
