#include "app/live/projector_keeper.h"

#include <fmt/format.h>
#include <signal.h>

#include <optional>
#include <utility>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

constexpr auto kPoll = std::chrono::milliseconds(4);

ProjectorProblem problem_of(const Error& error) {
    return {error.what(), error.remedy, dynamic_cast<const UnendedProjector*>(&error) != nullptr};
}

}  // namespace

ProjectorKeeper::ProjectorKeeper(const std::string& monitor, const ProjectorKeeperSettings& settings)
    : settings_(settings),
      window_at_(clock_.now().count()),
      session_at_(clock_.now().count()),
      projector_(std::make_unique<ProjectorProcess>(monitor, settings.process)),
      cover_(projector_->monitor()),
      dark_watch_(projector_->monitor()),
      monitor_(projector_->monitor()),
      width_(projector_->width()),
      height_(projector_->height()),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

ProjectorKeeper::~ProjectorKeeper() {
    go_dark();
    thread_.request_stop();
    thread_.join();
}

Instant ProjectorKeeper::show(const RgbImage& picture, Instant valid_until) {
    session_lives(clock_.now());
    std::unique_lock lock(mutex_);
    if (!projector_) throw DeviceError("Projector", problem_.what, problem_.remedy);
    if (!window_alive()) {
        darken();
        throw DeviceError("Projector", "the operator's window does not answer, and nothing may be lit meanwhile",
                          "End what else uses the computer.");
    }
    try {
        if (permitted_ && !permitted_()) {
            darken();
            return clock_.now();
        }
        dark_watch_.expect_dark_from(valid_until);
        projector_->renew();  // a picture that comes before the lease, or right after darkness, would be lost
        return projector_->show(picture, valid_until, permitted_);
    } catch (const Error& error) {
        lock.unlock();
        lose(problem_of(error));
        throw;
    }
}

void ProjectorKeeper::set_permission(std::function<bool()> permitted) {
    const std::lock_guard lock(mutex_);
    permitted_ = std::move(permitted);
}

void ProjectorKeeper::go_dark() noexcept {
    const std::lock_guard lock(mutex_);
    darken();
}

/// The watch is told first: its process may be waited for.
void ProjectorKeeper::darken() noexcept {
    dark_watch_.expect_dark_by(clock_.now());
    if (projector_) projector_->go_dark();
}

void ProjectorKeeper::disturb(int signal) noexcept {
    const std::lock_guard lock(mutex_);
    if (projector_ && projector_->process() > 0) kill(projector_->process(), signal);  // -1 is every process there is
}

void ProjectorKeeper::window_lives() {
    window_at_ = clock_.now().count();
}

void ProjectorKeeper::session_lives(Instant at) {
    Instant::rep before = session_at_;
    while (before < at.count() && !session_at_.compare_exchange_weak(before, at.count())) {
    }
}

ProjectorProblem ProjectorKeeper::problem() const {
    const std::lock_guard lock(mutex_);
    return problem_;
}

bool ProjectorKeeper::window_alive() const {
    return clock_.now() - Instant(window_at_) < settings_.window_patience;
}

bool ProjectorKeeper::alive() const {
    return window_alive() && clock_.now() - Instant(session_at_) < settings_.session_patience;
}

void ProjectorKeeper::start_again() {
    auto projector = std::make_unique<ProjectorProcess>(monitor_, settings_.process);  // black; takes a while
    if (projector->width() != width_ || projector->height() != height_)
        throw DeviceError("Projector",
                          fmt::format("it came back with {} x {} pixels, and had {} x {}", projector->width(),
                                      projector->height(), width_, height_),
                          "Set its resolution back.");
    const std::lock_guard lock(mutex_);
    projector_ = std::move(projector);
    ++starts_;
    problem_ = {};
}

void ProjectorKeeper::lose(const ProjectorProblem& problem) {
    dark_watch_.expect_dark_by(clock_.now());
    const std::lock_guard lock(mutex_);
    projector_.reset();
    cover_.cover();
    problem_ = problem;
    lost_at_ = clock_.now();
}

/// One that is lit though it should be dark is lost, and stays so until it is not.
void ProjectorKeeper::check_dark() {
    const DarkWatch::State state = dark_watch_.state();
    if (state == DarkWatch::State::as_it_should) return;
    const ProjectorProblem problem{
        "its monitor was to be dark, and the desktop still shows something there",
        state == DarkWatch::State::lit
            ? "Cover the lens, or switch the projector off. Log in to a desktop without a compositor."
            : "Its gamma was made black. Where light is seen: cover the lens. Use a desktop without a compositor.",
        true};
    std::unique_lock lock(mutex_);
    if (!projector_ && problem_.what == problem.what) {
        problem_ = problem;
        lost_at_ = clock_.now();
        return;
    }
    lock.unlock();
    lose(problem);
}

void ProjectorKeeper::run(const std::stop_token& stop) {
    constexpr Instant kFollow = std::chrono::milliseconds(250);
    std::optional<Instant> covered_at;
    while (!stop.stop_requested()) {
        try {
            std::unique_lock lock(mutex_);
            const bool lost = !projector_;
            const Instant lost_at = lost_at_;
            if (!lost) {
                projector_->check();
                if (alive())
                    projector_->renew();
                else
                    dark_watch_.expect_dark_by(clock_.now() + settings_.process.lease);
            }
            if (lost && (!covered_at || clock_.now() - *covered_at > kFollow))
                cover_.cover(), covered_at = clock_.now();
            if (!lost && covered_at) cover_.uncover(), covered_at.reset();
            lock.unlock();
            check_dark();
            if (lost && clock_.now() - lost_at > settings_.retry_after) start_again();  // beneath the cover
        } catch (const Error& error) {
            lose(problem_of(error));
        } catch (const std::exception& error) {
            lose({error.what(), "Start the session again."});
        }
        std::this_thread::sleep_for(kPoll);
    }
}

}  // namespace planlight
