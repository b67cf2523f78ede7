#pragma once

#include <memory>
#include <utility>

#include "app/live/room.h"

namespace planlight::test {

/// A room with other cameras: `Cameras` is made of the room's own and of what is handed in.
template <class Cameras>
class RoomWith final : public Room {
public:
    template <class... Arguments>
    explicit RoomWith(std::unique_ptr<Room> room, Arguments&&... arguments)
        : room_(std::move(room)), cameras_(room_->cameras(), std::forward<Arguments>(arguments)...) {}
    std::string name() const override { return room_->name(); }
    const RigCalibration& rig() const override { return room_->rig(); }
    Projector& projector() override { return room_->projector(); }
    StereoCamera& cameras() override { return cameras_; }
    const Clock& clock() const override { return room_->clock(); }
    RoomKind kind() const override { return room_->kind(); }
    void computing() override { room_->computing(); }
    void resting(Instant duration) override { room_->resting(duration); }
    void let_patient_move(bool moves) override { room_->let_patient_move(moves); }
    void begin_fault() override { room_->begin_fault(); }

private:
    std::unique_ptr<Room> room_;
    Cameras cameras_;
};

}  // namespace planlight::test
