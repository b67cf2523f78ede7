#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/image.h"
#include "planning_io/types/time.h"

namespace planlight {

/// What one camera saw in one exposure.
struct CameraFrame {
    GrayImage picture;
    Instant at{};        ///< mid-exposure, on the session's clock
    Instant exposure{};  ///< how long the shutter was open
    Instant at_sigma{};  ///< one standard deviation of `at`
};

/// Why there are no frames, with its remedy.
struct CameraFault {
    std::string problem, remedy;
};

/// Of a camera that sent nothing but one picture, over and over, for so long.
CameraFault sends_one_picture(std::int64_t for_ms);

/// Counts since the camera was opened.
struct CameraCounts {
    std::size_t received = 0, incomplete = 0, dropped = 0;  ///< dropped: nobody took them before newer ones came
    std::size_t repeated = 0;  ///< the picture before, sent again under a new time: no frames
    std::size_t clock_jumps = 0, lost_connections = 0;
    std::size_t lately = 0, lately_incomplete = 0;  ///< of the last 25 frames, whole or not
    bool own_clock = false;                         ///< frames have the camera's own times
    double clock_drift = 0;                         ///< seconds a second; positive: it runs slow
    Instant clock_sigma{};                          ///< one standard deviation of a frame's time, now
    Instant behind{};  ///< by so much the last frames came later than their times say they should; 0: in time
};

/// Wakes whoever waits for the frames of several cameras.
struct FrameBell {
    std::mutex mutex;
    std::condition_variable rung;
    std::uint64_t rings = 0;
    void ring();
};

/// The newest frames of one camera, handed from its own thread to who wants them: when it is full the oldest goes, so
/// that no picture of long ago is ever taken for a live one.
class FrameQueue {
public:
    static constexpr std::size_t kMost = 4;

    explicit FrameQueue(FrameBell& bell) : bell_(bell) {}
    void push(CameraFrame frame);
    void count_incomplete();
    void count_repeated();
    void count_jump();
    /// Of the camera's own clock: drift, uncertainty, and how much later than usual the last frames came (0: in time).
    void note_clock(double drift, Instant sigma, Instant behind);
    /// From now on `fault` says why nothing comes; frames that wait are thrown away.
    void fail(CameraFault fault);
    void recovered();

    std::vector<CameraFrame> take_all();
    bool waiting() const;  ///< a frame that nobody has taken yet
    std::optional<CameraFault> fault() const;
    CameraCounts counts() const;

private:
    FrameBell& bell_;
    mutable std::mutex mutex_;
    std::deque<CameraFrame> frames_;
    std::optional<CameraFault> fault_;
    CameraCounts counts_;
    std::deque<bool> lately_whole_;
    void note_whole(bool whole);
};

/// How a camera is connected. On no network: 0 bytes a packet.
struct CameraLink {
    int packet_bytes = 0;
    std::size_t frame_bytes = 0;
};

/// A camera that runs by itself from its making to its end.
class Camera {
public:
    virtual ~Camera() = default;
    virtual const std::string& name() const = 0;    ///< for a person: "Left camera (serial 1234)"
    virtual const std::string& serial() const = 0;  ///< what tells it from others
    virtual int width() const = 0;
    virtual int height() const = 0;
    /// What it does by itself and could not be told not to, a sentence each.
    virtual std::vector<std::string> notes() const { return {}; }
    virtual CameraLink link() const { return {}; }
    /// All its rows are known to be exposed together: nothing that happens after an exposure is in its picture.
    virtual bool global_shutter() const { return false; }
    virtual FrameQueue& frames() = 0;
};

}  // namespace planlight
