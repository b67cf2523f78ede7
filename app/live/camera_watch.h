#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "registration/devices/clipped_pixels.h"
#include "registration/devices/paired_cameras.h"
#include "registration/tracking/find_markers.h"

namespace planlight {

/// What is told of one camera while it is aimed, focused and exposed.
struct WatchedCamera {
    std::string name;
    int width = 0, height = 0;
    std::shared_ptr<const GrayImage> picture;  ///< the newest; null: none came yet
    std::vector<MarkerObservation> markers;    ///< found in it
    double sharpness = 0;                      ///< `focus_measure` of it
    double best_sharpness = 0;                 ///< seen since the watch began, or the best was forgotten
    ClippedShares clipped;
    double exposure_ms = 0;
    double frames_hz = 0;  ///< whole frames, of the last two seconds
    std::size_t received = 0, lost = 0, repeated = 0;
    std::vector<std::string> notes;    ///< what it does by itself
    std::optional<CameraFault> fault;  ///< why nothing comes
};

struct WatchedRoom {
    WatchedCamera left, right;
    /// Mid-exposures of the frames that belong together, right less left, median of the last ones; empty: not known
    /// yet.
    std::optional<double> apart_ms;
    double allowed_ms = 0;
    bool together() const { return apart_ms && std::abs(*apart_ms) <= allowed_ms; }
};

/// Watches two cameras by themselves, whether their exposures are one or not. `state` and `forget_best` may be called
/// from any thread, the rest from one.
class CameraWatch {
public:
    CameraWatch(Camera& left, Camera& right, const Clock& clock, const PairSettings& pairs,
                const MarkerSettings& markers = {});

    /// Takes what has come, and measures the newest picture of each.
    void look();
    /// Looks again and again.
    void run(const std::stop_token& stop);

    WatchedRoom state() const;
    /// The best sharpness is that of the next picture.
    void forget_best();

private:
    struct Side {
        Camera* camera;
        std::deque<std::pair<Instant, std::size_t>> counts;  ///< frames received by a moment
        Instant interval{};
    };
    std::vector<CameraFrame> take(Side& side, WatchedCamera& watched);
    void measure(const CameraFrame& newest, WatchedCamera& watched) const;
    void note_apart(const std::vector<CameraFrame>& lefts, const std::vector<CameraFrame>& rights);

    const Clock& clock_;
    PairSettings pairs_;
    MarkerSettings markers_;
    Side left_, right_;
    std::deque<double> apart_ms_;
    WatchedRoom now_;  ///< of the thread that looks
    mutable std::mutex mutex_;
    WatchedRoom state_;
    bool forget_ = false;
};

}  // namespace planlight
