#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "app/windows/operator_model.h"
#include "planning_io/types/time.h"
#include "registration/devices/stereo_camera.h"

namespace planlight {

/// The newest pictures of both cameras, for a window; from any thread.
class LiveView {
public:
    /// `clock`: of the wall; it outlives this.
    explicit LiveView(const Clock& clock) : clock_(clock) {}

    /// `old_after`: from then on a picture is not called live any more, wall time.
    void set_old_after(Instant old_after);

    /// True: a picture is shown together with what is found in it, not before; false: at once, without.
    void expect_found(bool expect);

    /// Keeps a copy, unless the last one was taken only a moment ago: a window shows no more than twenty a second.
    void take(const StereoFrame& frame);
    /// What was found in the frame of that time, where its pictures are those that are kept.
    void found(Instant at, std::vector<FoundMarker> left, std::vector<FoundMarker> right);
    /// Why no frame came, as a sentence that names a camera, or both are meant.
    void failed(const std::string& why);

    /// Pictures, their age, and why there is no newer one.
    void put_into(OperatorModel& model) const;

private:
    mutable std::mutex mutex_;
    const Clock& clock_;
    struct Pair {
        SeenPicture left, right;
        Instant at{};     ///< of the frame, on the room's clock
        Instant taken{};  ///< on the wall's
    };
    Pair shown_, next_;  ///< `next_`: what is in it is being looked for
    bool expect_found_ = false;
    Instant old_after_ = std::chrono::milliseconds(1500);
    std::string left_note_, right_note_;
};

/// A room's cameras; what they see is shown as well.
class CameraTap final : public StereoCamera {
public:
    CameraTap(StereoCamera& cameras, LiveView& view) : cameras_(cameras), view_(view) {}
    StereoFrame grab(Instant not_before, std::chrono::milliseconds patience) override;
    StereoFrame newest(Instant not_before, std::chrono::milliseconds patience) override;
    bool wait_until_exposed(Instant not_before, std::chrono::milliseconds patience) override {
        return cameras_.wait_until_exposed(not_before, patience);
    }
    std::string doubt() const override { return cameras_.doubt(); }

private:
    StereoCamera& cameras_;
    LiveView& view_;
};

}  // namespace planlight
