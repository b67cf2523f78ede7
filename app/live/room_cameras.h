#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/live/projector_keeper.h"
#include "planning_io/case/room_file.h"
#include "planning_io/types/rig_calibration.h"
#include "registration/devices/paired_cameras.h"

namespace planlight {

/// Both cameras of a room.
class RoomCameras {
public:
    /// Opens them, and looks at their frames for a second or two, until their clocks are known. Throws DeviceError when
    /// one does not answer, does not take its settings, or sends nothing.
    /// `progress`: told what is done, and how far; may be empty.
    RoomCameras(const RoomFile& room, const Clock& clock,
                const std::function<void(const std::string&, std::optional<double>)>& progress = {});

    PairedCameras& pair() { return *pair_; }
    const Camera& left() const { return *left_; }
    const Camera& right() const { return *right_; }
    /// What they do by themselves and cannot be told not to, a sentence each.
    std::vector<std::string> notes() const;

private:
    void learn_clocks(const Clock& clock, const std::function<void(double)>& progress);

    FrameBell bell_;
    Camera *left_ = nullptr, *right_ = nullptr;  ///< of `pair_`
    std::unique_ptr<PairedCameras> pair_;
};

/// The projector of a room for a command that has no operator window: it stays as long as the command runs. Nobody may
/// lie under it.
class CommandProjector {
public:
    /// With the delay of `projector_file`, where there is one. Throws DeviceError.
    CommandProjector(const std::string& monitor, const std::filesystem::path& projector_file);

    Projector& projector() { return keeper_; }

private:
    ProjectorKeeper keeper_;
    std::jthread beats_;
};

}  // namespace planlight
