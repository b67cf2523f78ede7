#pragma once

#include <functional>
#include <mutex>

#include "planning_io/dicom_net/find_series.h"

namespace planlight {

/// The images of a series on their way into a folder, each into a file of its UID. May be asked from any thread.
class IncomingImages {
public:
    using Progress = std::function<void(std::size_t, std::size_t)>;
    IncomingImages(const std::vector<ImageAtPeer>& images, std::filesystem::path folder, Progress progress);
    /// It was asked for, and is not here yet.
    bool lack(const std::string& uid) const;
    /// Of one that was asked for.
    std::filesystem::path file_of(const std::string& uid) const { return folder_ / (uid + ".dcm"); }
    /// The library has written it, of so many bytes at least: the last of them it writes without looking whether the
    /// disk takes them. False where the disk did not.
    bool take(const std::string& uid, std::size_t bytes);
    /// The library gives `fault` of an image that was coming.
    void note(const OFCondition& fault);
    std::size_t asked() const { return asked_.size(); }
    std::size_t came() const;
    bool are_whole() const { return came() == asked(); }
    const std::filesystem::path& folder() const { return folder_; }

    /// Throws DiskError where some did not come and it is the disk's fault, of which the library does not always speak.
    void check_disk() const;
    /// The disk has all of them afterwards. Throws DiskError.
    void sync() const;

private:
    const std::filesystem::path folder_;
    const Progress progress_;
    std::set<std::string> asked_;
    mutable std::mutex mutex_;
    std::set<std::string> came_;
    bool disk_failed_ = false;
};

}  // namespace planlight
