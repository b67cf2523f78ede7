#pragma once

#include <memory>
#include <string>

#include "app/live/room_cameras.h"
#include "projection/monitor/test_pictures.h"

namespace planlight {

/// The projector of a room while it shows test pictures. Each expires by itself a second after the last `keep`, so that
/// a window that hangs leaves no light; dark at its end.
class TestLight {
public:
    /// Shows nothing yet. Nobody may lie under the projector. Throws DeviceError where there is none.
    TestLight(const RoomFile& room, const RoomCameras& cameras, const Clock& clock);
    /// With any projector, `monitor` by name and size.
    TestLight(Projector& projector, const Monitor& monitor, const Clock& clock);
    ~TestLight();
    TestLight(const TestLight&) = delete;
    TestLight& operator=(const TestLight&) = delete;

    /// From now on that picture; dark at once. What cannot be shown is dark, and `trouble`.
    void show(TestPicture picture);
    /// To be called often: the picture is shown again before it expires.
    void keep();

    TestPicture shown() const { return shown_; }
    /// Why the last picture went out by itself; empty: it did not.
    const ProjectorProblem& trouble() const { return trouble_; }

private:
    std::unique_ptr<CommandProjector> opened_;  ///< null: it is somebody else's
    Projector& projector_;
    const Clock& clock_;
    Monitor monitor_;
    int number_ = 0;  ///< of the monitor, as they are listed
    TestPicture shown_ = TestPicture::dark;
    RgbImage picture_;
    Instant valid_until_{};
    ProjectorProblem trouble_;
};

}  // namespace planlight
