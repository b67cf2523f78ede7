#include "app/live/light_keeper.h"

#include <signal.h>

#include <algorithm>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

constexpr auto kPoll = std::chrono::milliseconds(4);

}  // namespace

RgbImage fit_picture(const RgbImage& picture, int width, int height) {
    if (picture.width == width && picture.height == height) return picture;
    const double scale =
        std::min(static_cast<double>(width) / picture.width, static_cast<double>(height) / picture.height);
    const double left = (width - scale * picture.width) / 2, top = (height - scale * picture.height) / 2;
    RgbImage out(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const int sx = static_cast<int>((x + 0.5 - left) / scale), sy = static_cast<int>((y + 0.5 - top) / scale);
            if (x + 0.5 > left && y + 0.5 > top && sx < picture.width && sy < picture.height)
                out.at(x, y) = picture.at(sx, sy);
        }
    return out;
}

LightKeeper::LightKeeper(const std::string& monitor, const LiveSession& session, const LightKeeperSettings& settings)
    : monitor_(monitor),
      session_(session),
      settings_(settings),
      window_beat_(clock_.now().count()),
      projector_(std::make_unique<ProjectorProcess>(monitor, settings.process)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

LightKeeper::~LightKeeper() {
    go_dark();
    thread_.request_stop();
    thread_.join();
}

void LightKeeper::beat() {
    window_beat_ = clock_.now().count();
}

void LightKeeper::go_dark() noexcept {
    const std::lock_guard lock(mutex_);
    if (projector_) projector_->go_dark();
}

LightKeeper::Problem LightKeeper::problem() const {
    const std::lock_guard lock(mutex_);
    return problem_;
}

void LightKeeper::disturb(int signal) noexcept {
    const std::lock_guard lock(mutex_);
    if (projector_) kill(projector_->process(), signal);
}

bool LightKeeper::alive() const {
    const Instant now = clock_.now();
    return now - Instant(window_beat_) < settings_.window_patience &&
           now - session_.alive_at() < settings_.session_patience;
}

/// One look at the session's light. Under the lock.
void LightKeeper::follow() {
    projector_->check();
    if (alive()) projector_->renew();
    const LiveSession::Light light = session_.light();
    if (light.number == number_) return;
    number_ = light.number;
    if (light.picture)
        projector_->show(fit_picture(*light.picture, projector_->width(), projector_->height()),
                         clock_.now() + settings_.picture_validity);
    else
        projector_->go_dark();
}

void LightKeeper::start_again() {
    auto projector = std::make_unique<ProjectorProcess>(monitor_, settings_.process);  // black; takes a while
    const std::lock_guard lock(mutex_);
    projector_ = std::move(projector);
    number_ = session_.light().number;  // what was lit before is not lit again by itself
    problem_ = {};
}

void LightKeeper::lose(const Problem& problem) {
    const std::lock_guard lock(mutex_);
    projector_.reset();
    problem_ = problem;
    lost_at_ = clock_.now();
}

void LightKeeper::run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        try {
            std::unique_lock lock(mutex_);
            const bool lost = !projector_;
            if (!lost) follow();
            lock.unlock();
            if (lost && clock_.now() - lost_at_ > settings_.retry_after) start_again();
        } catch (const Error& error) {
            lose({error.what(), error.remedy});
        } catch (const std::exception& error) {
            lose({error.what(), "Start the session again."});
        }
        std::this_thread::sleep_for(kPoll);
    }
}

}  // namespace planlight
