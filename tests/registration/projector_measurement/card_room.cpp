#include "tests/registration/projector_measurement/card_room.h"

namespace planlight::test {

namespace {

simulation::BoardRoomSettings one_pose(simulation::BoardRoomSettings settings) {
    settings.poses = 1;
    settings.max_tilt_deg = 20;
    return settings;
}

}  // namespace

CardRoom::CardRoom(const simulation::BoardRoomSettings& settings)
    : room(simulation::white_card(), one_pose(settings)), bench{room.projector(),
                                                                room.cameras(),
                                                                room.clock(),
                                                                [this](Instant at) { room.wait(at - room.clock().now()); },
                                                                {},
                                                                {}} {}

std::vector<double> true_delays_s(const LightRecording& recording, const std::vector<simulation::TrueLight>& truth) {
    std::vector<double> delays;
    for (const LightOrder& order : recording.orders)
        for (const simulation::TrueLight& light : truth)
            if (light.asked == order.at && light.shown) {
                delays.push_back(seconds(light.lit - light.asked));
                break;
            }
    return delays;
}

}  // namespace planlight::test
