#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/live/projector_keeper.h"
#include "app/live/recorded_room.h"
#include "planning_io/case/room_file.h"
#include "planning_io/types/error.h"
#include "planning_io/types/rig_calibration.h"
#include "registration/devices/paired_cameras.h"

namespace planlight {

/// Both cameras of a room: real ones, or a recording that is played.
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
    /// They play a recording, and nothing is seen live.
    bool recorded() const { return recorded_; }
    /// The projector that the recorded scan was lit by, to which these cameras answer; null where none was recorded.
    /// `behind`: a real one that is lit as well, or null.
    std::unique_ptr<Projector> recorded_projector(const Clock& clock, Projector* behind) const;

private:
    using Progress = std::function<void(const std::string&, std::optional<double>)>;
    void open_real(const RoomFile& room, const Clock& clock, const Progress& tell);
    void open_recorded(const RoomRecording& recording, const Clock& clock);
    void learn_clocks(const Clock& clock, const std::function<void(double)>& progress);

    FrameBell bell_;
    bool recorded_ = false;
    std::shared_ptr<RecordedLight> light_;  ///< of a recorded scan; null: there is none
    int light_width_ = 0, light_height_ = 0;
    RecordedProjector::Which which_;
    Camera *left_ = nullptr, *right_ = nullptr;  ///< of `pair_`
    std::unique_ptr<PairedCameras> pair_;
};

/// Which exposures are one, as room.json says.
PairSettings pair_settings(const RoomFile& room);

/// Of a room without a monitor and without a recorded scan.
DeviceError no_projector();

/// The projector of a room for a command that has no operator window: it stays as long as the command runs. Nobody may
/// lie under it.
class CommandProjector {
public:
    /// On the room's monitor, with the delay of its projector file, where there is one; of a recorded scan the one that
    /// its cameras answer to. `cameras`: null where they could not be opened. Throws DeviceError.
    CommandProjector(const RoomFile& room, const RoomCameras* cameras);

    Projector& projector() { return recorded_ ? *recorded_ : *keeper_; }

private:
    SteadyClock clock_;
    std::unique_ptr<ProjectorKeeper> keeper_;  ///< null: the room has no monitor
    std::unique_ptr<Projector> recorded_;      ///< null: the light is seen by real cameras
    std::jthread beats_;
};

}  // namespace planlight
