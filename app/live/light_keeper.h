#pragma once

#include <string>
#include <thread>

#include "app/live/live_session.h"
#include "app/live/projector_keeper.h"

namespace planlight {

/// Brings a copy of the newest light of a simulated room to a projector window, from a thread of its own.
///
/// A projector that is lost is dark, said, and started again by itself when it is back; lit again only by the session's
/// next picture.
class LightKeeper {
public:
    /// `picture_validity`: of a picture of the simulated room, by the wall; that room computes longer than a real one
    /// exposes.
    LightKeeper(ProjectorKeeper& projector, const LiveSession& session,
                Instant picture_validity = std::chrono::milliseconds(2500));
    ~LightKeeper();

private:
    void run(const std::stop_token& stop);
    void follow();

    ProjectorKeeper& projector_;
    const LiveSession& session_;
    Instant picture_validity_;
    SteadyClock clock_;
    std::uint64_t number_ = 0;  ///< of the light that was shown last
    unsigned starts_ = 0;
    std::jthread thread_;
};

/// `picture` for a monitor of another size: scaled by nearest pixel, so that nothing is invented; black bars.
RgbImage fit_picture(const RgbImage& picture, int width, int height);

}  // namespace planlight
