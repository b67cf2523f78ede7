#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "app/live/live_session.h"
#include "planning_io/types/steady_clock.h"
#include "projection/projector_process.h"

namespace planlight {

/// Patiences are of the wall's clock, whatever clock the room has.
struct LightKeeperSettings {
    ProjectorProcessSettings process;
    /// Since the operator window's last frame: without graphics hardware one may take half a second.
    Instant window_patience = std::chrono::seconds(1);
    /// Since the session's last sign of life. The simulated room computes longer than a real one exposes.
    Instant session_patience = std::chrono::milliseconds(2500);
    Instant picture_validity = std::chrono::milliseconds(2500);  ///< of a picture of the simulated room, by the wall
    Instant retry_after = std::chrono::seconds(1);               ///< after the projector was lost
};

/// Brings the session's newest light to the projector process, from a thread of its own, and keeps the lease of that
/// light only while the operator window and the session both show signs of life: where either hangs, it is dark.
///
/// A projector that is lost (unplugged, moved, its process ended) is dark, said, and started again by itself when it
/// is back; lit again only by the session's next picture.
class LightKeeper {
public:
    /// Throws DeviceError when the projector cannot be opened now.
    LightKeeper(const std::string& monitor, const LiveSession& session, const LightKeeperSettings& settings = {});
    ~LightKeeper();

    /// The operator window has drawn a frame.
    void beat();
    void go_dark() noexcept;

    /// Why there is no light to be had, with its remedy; empty while the projector answers.
    struct Problem {
        std::string what, remedy;
        bool empty() const { return what.empty(); }
    };
    Problem problem() const;

    /// For tests: sends that signal to the projector process, if there is one.
    void disturb(int signal) noexcept;

private:
    void run(const std::stop_token& stop);
    void follow();
    bool alive() const;
    void start_again();
    void lose(const Problem& problem);

    std::string monitor_;
    const LiveSession& session_;
    LightKeeperSettings settings_;
    SteadyClock clock_;
    std::atomic<Instant::rep> window_beat_;
    mutable std::mutex mutex_;
    std::unique_ptr<ProjectorProcess> projector_;
    Problem problem_;
    Instant lost_at_{};         ///< of the keeper's thread alone
    std::uint64_t number_ = 0;  ///< of the light that was shown last
    std::jthread thread_;
};

/// `picture` for a monitor of another size: scaled by nearest pixel, so that nothing is invented; black bars.
RgbImage fit_picture(const RgbImage& picture, int width, int height);

}  // namespace planlight
