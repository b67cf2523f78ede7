#pragma once

#include <deque>
#include <memory>
#include <optional>

#include "registration/devices/camera.h"
#include "registration/devices/exposure_times.h"
#include "registration/devices/stereo_camera.h"

namespace planlight {

/// Which exposures of two cameras are one.
struct PairSettings {
    double apart_of_exposure = 0.1;                        ///< mid-exposures may be apart by so much of an exposure,
    Instant most_apart = std::chrono::milliseconds(2);     ///< by this at most,
    Instant least_apart = std::chrono::microseconds(200);  ///< and by this in any case: clocks are no truer
    /// One camera triggers the other, or both are triggered by one line: their exposures coincide by wire, and their
    /// times need only tell which belongs to which (a third of the time between two frames, 10 ms at most).
    bool together = false;
};

/// How far the mid-exposures of two frames may be apart to be one, either way. `exposure`: the shorter one; `interval`:
/// between two frames of the left camera, 0: not known.
Instant allowed_apart(const PairSettings& settings, Instant exposure, Instant interval);

/// What became of the frames of two cameras.
struct PairCounts {
    std::size_t pairs = 0, left_alone = 0, right_alone = 0;
    Instant apart{};    ///< right less left of the last pair, or of the last two that made none
    Instant allowed{};  ///< how far these might be apart
};

/// Two cameras that run by themselves, as one that exposes both together: frames are paired by their times.
class PairedCameras final : public StereoCamera {
public:
    /// `bell` must be that of both cameras' queues.
    PairedCameras(std::unique_ptr<Camera> left, std::unique_ptr<Camera> right, FrameBell& bell, const Clock& clock,
                  const PairSettings& settings = {});

    /// Throws DeviceError, with the camera by name, when a camera failed, sends nothing, or the two do not expose
    /// together.
    StereoFrame grab(Instant not_before, std::chrono::milliseconds patience) override;

    /// As `grab`, but the newest pair that is there, for following a patient.
    StereoFrame newest(Instant not_before, std::chrono::milliseconds patience) override;

    /// By the steps in which both cameras expose. False: they do not run evenly, that is not known yet, or a shutter is
    /// not known to be global: its last rows would see what comes after.
    bool wait_until_exposed(Instant not_before, std::chrono::milliseconds patience) override;

    /// A camera that is behind, or many of whose frames lose packets.
    std::string doubt() const override;

    const PairCounts& counts() const { return counts_; }
    Camera& left() { return *left_; }
    Camera& right() { return *right_; }

private:
    StereoFrame wait_for_pair(Instant not_before, std::chrono::milliseconds patience, bool newest);
    void collect();
    std::optional<Instant> closing_of_pair(Instant not_before) const;
    std::optional<StereoFrame> next_pair(Instant not_before);
    [[noreturn]] void refuse(std::chrono::milliseconds patience) const;

    std::unique_ptr<Camera> left_, right_;
    FrameBell& bell_;
    const Clock& clock_;
    PairSettings settings_;
    std::deque<CameraFrame> lefts_, rights_;
    std::size_t lefts_seen_ = 0, rights_seen_ = 0;            ///< in this call
    std::size_t left_incomplete_ = 0, right_incomplete_ = 0;  ///< when it began
    PairCounts counts_;
    std::optional<Instant> nearest_;    ///< of two that made no pair in this call: how far they were apart
    Instant last_left_{}, interval_{};  ///< of the left camera's frames; 0: not known yet
    ExposureTimes left_times_, right_times_;
};

}  // namespace planlight
