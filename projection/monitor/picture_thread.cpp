#include "projection/monitor/picture_thread.h"

#include <chrono>
#include <new>
#include <stdexcept>

#include "planning_io/types/error.h"
#include "projection/monitor/picture_painter.h"

namespace planlight {
namespace {

constexpr auto kToStart = std::chrono::seconds(5);
constexpr auto kHangs = std::chrono::milliseconds(500);     ///< a picture that is not drawn by then
constexpr auto kExpiryPoll = std::chrono::milliseconds(3);  ///< the injected clock can only be asked, not waited for

DeviceError failed(const std::string& problem) {
    return {"projector window", problem, "update the graphics driver, or set LIBGL_ALWAYS_SOFTWARE=1"};
}

}  // namespace

PictureThread::PictureThread(GLFWwindow* window, int width, int height, const Clock& clock)
    : window_(window), width_(width), height_(height), clock_(clock) {
    wanted_ = 1;
    thread_ = std::thread([this] { run(); });
    std::unique_lock lock(mutex_);
    if (drawn_changed_.wait_for(lock, kToStart, [&] { return drawn_ >= 1 || !failure_.empty(); }) && failure_.empty())
        return;
    const std::string problem = failure_.empty() ? "the graphics driver does not answer" : failure_;
    stop_ = true;
    wanted_changed_.notify_all();
    lock.unlock();
    thread_.join();
    throw failed(problem);
}

PictureThread::~PictureThread() {
    go_dark();
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    wanted_changed_.notify_all();
    thread_.join();
}

void PictureThread::show(const RgbImage& picture, Instant valid_until) {
    std::unique_lock lock(mutex_);
    picture_ = picture;
    valid_until_ = valid_until;
    lit_ = true;
    const std::uint64_t number = ++wanted_;
    wanted_changed_.notify_all();
    if (drawn_in_time(lock, number)) return;
    lit_ = false;
    picture_ = {};
    ++wanted_;
    wanted_changed_.notify_all();
    throw failed(failure_.empty() ? "the picture was not drawn within half a second" : failure_);
}

void PictureThread::go_dark() noexcept {
    std::unique_lock lock(mutex_);
    lit_ = false;
    picture_ = {};
    const std::uint64_t number = ++wanted_;
    wanted_changed_.notify_all();
    if (!drawn_in_time(lock, number) && failure_.empty()) failure_ = "black was not drawn within half a second";
}

void PictureThread::check() {
    const std::lock_guard lock(mutex_);
    if (!failure_.empty()) throw failed(failure_);
    const bool behind = wanted_ != drawn_ || (lit_ && clock_.now() >= valid_until_);
    if (!behind || (behind_since_ && behind_at_ != drawn_)) behind_since_.reset();
    if (!behind) return;
    const auto now = std::chrono::steady_clock::now();
    if (!behind_since_) {
        behind_since_ = now;
        behind_at_ = drawn_;
    }
    if (now - *behind_since_ < kHangs) return;
    failure_ = "the graphics driver does not answer any more";
    throw failed(failure_);
}

void PictureThread::redraw() {
    const std::lock_guard lock(mutex_);
    ++wanted_;
    wanted_changed_.notify_all();
}

void PictureThread::read_back(bool wanted) {
    const std::lock_guard lock(mutex_);
    read_back_ = wanted;
}

bool PictureThread::dark() const {
    const std::lock_guard lock(mutex_);
    return !lit_ || clock_.now() >= valid_until_;
}

bool PictureThread::drawn_in_time(std::unique_lock<std::mutex>& lock, std::uint64_t number) {
    return drawn_changed_.wait_for(lock, kHangs, [&] { return drawn_ >= number || !failure_.empty(); }) &&
           failure_.empty();
}

/// Waits for a request or for the expiry of what is lit, whichever comes first.
void PictureThread::wait_and_take(std::unique_lock<std::mutex>& lock) {
    while (!stop_ && wanted_ == drawn_) {
        if (lit_)
            wanted_changed_.wait_for(lock, kExpiryPoll);
        else
            wanted_changed_.wait(lock);
        if (lit_ && clock_.now() >= valid_until_) ++wanted_;
    }
    if (lit_ && clock_.now() >= valid_until_) lit_ = false;
    if (!lit_) picture_ = {};
}

void PictureThread::draw_what_is_wanted(PicturePainter& painter) {
    std::unique_lock lock(mutex_);
    while (true) {
        wait_and_take(lock);
        if (stop_) break;
        const std::uint64_t number = wanted_;
        const RgbImage picture = picture_;
        const bool read_back = read_back_;
        lock.unlock();
        painter.draw(picture, read_back);
        lock.lock();
        drawn_ = number;
        drawn_changed_.notify_all();
    }
    lock.unlock();
    painter.draw({}, false);
}

void PictureThread::run() {
    const auto give_up = [this](const char* why) {
        const std::lock_guard lock(mutex_);
        lit_ = false;
        failure_ = why;
        drawn_changed_.notify_all();
    };
    try {
        PicturePainter painter(window_, width_, height_);
        try {
            draw_what_is_wanted(painter);
        } catch (...) {
            painter.try_black();  // before all else: also where it failed before it drew anything
            throw;
        }
    } catch (const std::bad_alloc&) {
        give_up("there is no memory for its picture");
    } catch (const std::exception& error) {
        give_up(error.what());
    }
}

}  // namespace planlight
