#include "app/live/test_light.h"

#include "planning_io/types/error.h"

namespace planlight {
namespace {

constexpr Instant kValid = std::chrono::seconds(1), kShowAgainBefore = std::chrono::milliseconds(600);

}  // namespace

TestLight::TestLight(const RoomFile& room, const RoomCameras& cameras, const Clock& clock)
    : opened_(std::make_unique<CommandProjector>(room, &cameras)), projector_(opened_->projector()), clock_(clock) {
    monitor_.name = room.monitor;
    if (!room.monitor.empty()) {
        const std::vector<Monitor> all = list_monitors();
        for (std::size_t i = 0; i < all.size(); ++i)
            if (all[i].name == room.monitor) {
                monitor_ = all[i];
                number_ = static_cast<int>(i);
            }
    }
    monitor_.width = projector_.width();
    monitor_.height = projector_.height();
}

TestLight::TestLight(Projector& projector, const Monitor& monitor, const Clock& clock)
    : projector_(projector), clock_(clock), monitor_(monitor) {}

TestLight::~TestLight() {
    projector_.go_dark();
}

void TestLight::show(TestPicture picture) {
    trouble_ = {};
    shown_ = picture;
    valid_until_ = {};
    if (picture == TestPicture::dark) {
        projector_.go_dark();
        return;
    }
    picture_ = draw_test_picture(picture, monitor_, number_);
    keep();
}

void TestLight::keep() {
    if (shown_ == TestPicture::dark || clock_.now() < valid_until_ - kShowAgainBefore) return;
    try {
        valid_until_ = clock_.now() + kValid;
        projector_.show(picture_, valid_until_);
    } catch (const DeviceError& error) {
        projector_.go_dark();
        shown_ = TestPicture::dark;
        trouble_ = {error.what(), error.remedy};
    }
}

}  // namespace planlight
