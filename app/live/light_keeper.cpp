#include "app/live/light_keeper.h"

#include <algorithm>

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

LightKeeper::LightKeeper(ProjectorKeeper& projector, const LiveSession& session, Instant picture_validity)
    : projector_(projector),
      session_(session),
      picture_validity_(picture_validity),
      starts_(projector.starts()),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

LightKeeper::~LightKeeper() {
    thread_.request_stop();
    thread_.join();
    projector_.go_dark();
}

/// One look at the session's light.
void LightKeeper::follow() {
    const LiveSession::Light light = session_.light();
    const unsigned starts = projector_.starts();
    if (starts != starts_) number_ = light.number;  // what was lit before is not lit again by itself
    starts_ = starts;
    if (light.number == number_) return;
    number_ = light.number;
    if (light.picture)
        projector_.show(fit_picture(*light.picture, projector_.width(), projector_.height()),
                        clock_.now() + picture_validity_);
    else
        projector_.go_dark();
}

void LightKeeper::run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        try {
            follow();
        } catch (const std::exception&) {  // the keeper tells what is wrong with the projector
        }
        std::this_thread::sleep_for(kPoll);
    }
}

}  // namespace planlight
