#include "planning_io/dicom_net/incoming_images.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "planning_io/files/held_end_signals.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

void sync_file(const fs::path& file) {
    const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    const int failed = fd < 0 ? -1 : ::fsync(fd);
    const int why = errno;
    if (fd >= 0) ::close(fd);
    if (failed) throw DiskError(file, std::strerror(why), "Check the free space of the disk, then fetch again.");
}

bool takes_a_large_image(const fs::path& folder) {
    const fs::path probe = folder / "probe";
    try {
        write_safely(probe, std::string(std::size_t{1} << 23, ' '));
    } catch (const DiskError&) {
        return false;
    }
    std::error_code ignored;
    fs::remove(probe, ignored);
    return true;
}

}  // namespace

IncomingImages::IncomingImages(const std::vector<ImageAtPeer>& images, fs::path folder, Progress progress)
    : folder_(std::move(folder)), progress_(std::move(progress)) {
    for (const ImageAtPeer& image : images) asked_.insert(image.uid);
}

bool IncomingImages::lack(const std::string& uid) const {
    const std::lock_guard lock(mutex_);
    return asked_.contains(uid) && !came_.contains(uid);
}

bool IncomingImages::take(const std::string& uid, std::size_t bytes) {
    std::error_code fault;
    const auto size = fs::file_size(file_of(uid), fault);
    std::size_t count = 0;
    {
        const std::lock_guard lock(mutex_);
        if (fault || size < bytes || HeldEndSignals::one_waits()) {
            disk_failed_ = true;
            return false;
        }
        came_.insert(uid);
        count = came_.size();
    }
    if (progress_) progress_(count, asked());
    return true;
}

void IncomingImages::note(const OFCondition& fault) {
    const std::lock_guard lock(mutex_);
    if (fault == DIMSE_OUTOFRESOURCES) disk_failed_ = true;
}

std::size_t IncomingImages::came() const {
    const std::lock_guard lock(mutex_);
    return came_.size();
}

void IncomingImages::check_disk() const {
    if (are_whole()) return;
    const bool failed = [this] {
        const std::lock_guard lock(mutex_);
        return disk_failed_;
    }();
    if (failed || !takes_a_large_image(folder_))
        throw DiskError(folder_, "the disk did not take an image",
                        "Check the free space and the permissions of the folder, then fetch again.");
}

void IncomingImages::sync() const {
    for (const std::string& uid : asked_) sync_file(file_of(uid));
}

}  // namespace planlight
