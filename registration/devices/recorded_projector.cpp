#include "registration/devices/recorded_projector.h"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "planning_io/types/error.h"

namespace planlight {

RecordedProjector::RecordedProjector(int width, int height, Which which, std::shared_ptr<RecordedLight> light,
                                     const Clock& clock, Projector* behind)
    : width_(width),
      height_(height),
      which_(std::move(which)),
      light_(std::move(light)),
      clock_(clock),
      behind_(behind) {
    if (behind_ && (behind_->width() != width_ || behind_->height() != height_))
        throw DeviceError("Projector",
                          fmt::format("it has {} x {} pixels, and the scan was recorded with {} x {}", behind_->width(),
                                      behind_->height(), width_, height_),
                          "Set its resolution to that of the recording, or leave the monitor out of room.json.");
}

Instant RecordedProjector::show(const RgbImage& picture, Instant valid_until) {
    if (picture.width != width_ || picture.height != height_) {
        go_dark();
        throw DeviceError("Projector",
                          fmt::format("a picture of {} x {} pixels cannot be shown by {} x {}", picture.width,
                                      picture.height, width_, height_),
                          "Give it the size of the recorded scan.");
    }
    const auto number = which_(picture);
    const Instant from = behind_ ? behind_->show(picture, valid_until) : clock_.now();
    light_->shows(number, from, valid_until);
    return from;
}

void RecordedProjector::go_dark() noexcept {
    if (behind_) behind_->go_dark();
    try {
        light_->shows(std::nullopt, clock_.now(), std::numeric_limits<Instant>::max());
    } catch (...) {  // no memory: the order before expires by itself
    }
}

}  // namespace planlight
