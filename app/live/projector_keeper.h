#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "planning_io/types/steady_clock.h"
#include "projection/monitor/dark_cover.h"
#include "projection/monitor/dark_watch.h"
#include "projection/monitor/projector_process.h"

namespace planlight {

/// Patiences are of the wall's clock, whatever clock the room has.
struct ProjectorKeeperSettings {
    ProjectorProcessSettings process;
    /// Since the operator window's last frame: without graphics hardware one may take half a second.
    Instant window_patience = std::chrono::seconds(1);
    Instant session_patience = std::chrono::seconds(1);  ///< since the session's last sign of life
    Instant retry_after = std::chrono::seconds(1);       ///< after the projector was lost
};

/// Why there is no light to be had, with its remedy; empty while the projector answers.
struct ProjectorProblem {
    std::string what, remedy;
    bool may_be_lit = false;  ///< nobody can make it dark any more
    bool empty() const { return what.empty(); }
};

/// The projector of a session: its process is watched, its lease is kept only while the operator window and the session
/// both show signs of life (where either hangs, it is dark), and it is started again when it was lost (unplugged,
/// moved, its process ended): dark then, until the next picture, and its monitor covered (`DarkCover`), lest the
/// desktop's own picture lies on the patient. Where its monitor is lit though it should be dark (`DarkWatch`), it
/// counts as lost until it is not. On the same output then, also where it was asked for by its number.
///
/// May be used from any thread.
class ProjectorKeeper final : public Projector {
public:
    /// Throws DeviceError when the projector cannot be opened now.
    explicit ProjectorKeeper(const std::string& monitor, const ProjectorKeeperSettings& settings = {});
    ~ProjectorKeeper() override;

    int width() const override { return width_; }
    int height() const override { return height_; }
    /// Throws DeviceError while the projector is lost, or when it is found to be; and, dark, while the operator window
    /// does not answer, for the lease has run out then and nothing would be lit, and where the light is not permitted.
    /// Whoever shows is alive.
    Instant show(const RgbImage& picture, Instant valid_until) override;
    void go_dark() noexcept override;

    /// Asked right before a picture goes to the projector, in one piece with that: a picture that was on its way as
    /// DARK was pressed is not lit after it. Must not call back into the keeper. To be set before the first `show`;
    /// empty: all light is permitted.
    void set_permission(std::function<bool()> permitted);
    void window_lives();             ///< the operator window has drawn a frame
    void session_lives(Instant at);  ///< its last sign of life
    ProjectorProblem problem() const;
    /// Counts up with every start of the projector.
    unsigned starts() const { return starts_; }
    /// For tests: sends that signal to the projector process, if there is one.
    void disturb(int signal) noexcept;

private:
    void run(const std::stop_token& stop);
    bool window_alive() const;
    bool alive() const;
    void start_again();
    void check_dark();
    void darken() noexcept;  ///< under the lock
    void lose(const ProjectorProblem& problem);

    ProjectorKeeperSettings settings_;
    SteadyClock clock_;
    std::atomic<Instant::rep> window_at_, session_at_;
    mutable std::mutex mutex_;
    std::unique_ptr<ProjectorProcess> projector_;
    DarkCover cover_;  ///< outlives the last look at what is dark
    DarkWatch dark_watch_;
    std::string monitor_;  ///< its name
    ProjectorProblem problem_;
    std::function<bool()> permitted_;
    Instant lost_at_{};
    std::atomic<unsigned> starts_{1};
    int width_ = 0, height_ = 0;
    std::jthread thread_;
};

}  // namespace planlight
