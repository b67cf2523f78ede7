#include "planning_io/recording/file_window.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace planlight {
namespace {

constexpr std::size_t kAfterAJump = std::size_t{1} << 13, kWindow = std::size_t{1} << 17;

}  // namespace

FileWindow::FileWindow(const std::filesystem::path& file)
    : file_(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)), window_(kWindow) {}

FileWindow::~FileWindow() {
    if (file_ >= 0) ::close(file_);
}

std::size_t FileWindow::read(std::uint64_t at, char* to, std::size_t count) {
    std::size_t got = 0;
    while (got < count) {
        const ssize_t some = ::pread(file_, to + got, count - got, static_cast<off_t>(at + got));
        if (some < 0 && errno == EINTR) continue;
        failed_ = some < 0;
        if (some <= 0) break;
        got += static_cast<std::size_t>(some);
    }
    return got;
}

std::string_view FileWindow::bytes(std::uint64_t at, std::size_t count) {
    failed_ = false;
    if (at < from_ || at + count > from_ + filled_) {
        if (count > window_.size()) window_.resize(count);
        const bool goes_on = filled_ > 0 && at >= from_ && at <= from_ + filled_;
        piece_ = goes_on ? std::min(2 * piece_, kWindow) : kAfterAJump;
        const std::size_t wanted = std::max(count, piece_);
        from_ = at;
        filled_ = read(at, window_.data(), wanted);
        read_ += filled_;
        if (filled_ >= count) failed_ = false;  // what was asked for is there
    }
    return {window_.data() + (at - from_), std::min(count, filled_ - static_cast<std::size_t>(at - from_))};
}

}  // namespace planlight
