#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "planning_io/types/image.h"
#include "planning_io/types/time.h"

struct GLFWwindow;

namespace planlight {

class PicturePainter;

/// Owns the graphics context of the projector window and draws its picture 1:1, or black, from a thread of its own, so
/// that the picture expires even while the rest of the program hangs.
class PictureThread {
public:
    /// Draws black at once. Throws DeviceError when the graphics driver refuses.
    PictureThread(GLFWwindow* window, int width, int height, const Clock& clock);
    ~PictureThread();  ///< black, then done
    PictureThread(const PictureThread&) = delete;
    PictureThread& operator=(const PictureThread&) = delete;

    /// Returns when the picture has been handed to the display. Throws DeviceError when that fails or takes over
    /// half a second: the light before it cannot expire meanwhile.
    void show(const RgbImage& picture, Instant valid_until);
    /// Returns when black has been handed to the display, after half a second at most; `check` says whether it has
    /// been.
    void go_dark() noexcept;
    /// Throws DeviceError when the thread could not draw what it should and has ended, black was not drawn in time, or
    /// nothing was drawn for half a second though something should be, an expired picture's black say: what the display
    /// shows is not known then. To be called again and again. A thread that hangs in the graphics driver cannot be
    /// waited for: the destructor would not return.
    void check();
    /// Draws again what should be seen (the window system lost it).
    void redraw();
    /// Whether what is drawn is read back, from the next redraw on: for a window that is seen, stays where it is and
    /// has no other before it (of others the buffer need not hold anything). At first it is not.
    void read_back(bool wanted);
    bool dark() const;

private:
    void run();
    void draw_what_is_wanted(PicturePainter& painter);
    void wait_and_take(std::unique_lock<std::mutex>& lock);
    bool drawn_in_time(std::unique_lock<std::mutex>& lock, std::uint64_t number);

    GLFWwindow* window_;
    int width_, height_;
    const Clock& clock_;

    mutable std::mutex mutex_;
    std::condition_variable wanted_changed_, drawn_changed_;
    RgbImage picture_;  ///< empty: black
    Instant valid_until_{};
    bool lit_ = false, stop_ = false, read_back_ = false;
    std::uint64_t wanted_ = 0, drawn_ = 0;  ///< counts of requests
    /// Since when `check` has seen that something is to be drawn, and how much had been drawn then.
    std::optional<std::chrono::steady_clock::time_point> behind_since_;
    std::uint64_t behind_at_ = 0;
    std::string failure_;
    std::thread thread_;
};

}  // namespace planlight
