#pragma once

#include "registration/devices/projector.h"
#include "registration/devices/stereo_camera.h"

namespace planlight {

class SessionObserver;

/// A session's devices and clock; all that they answer is told to an observer first.
class ObservedDevices {
public:
    /// `observer` null: nothing is told. Keeps references to all.
    ObservedDevices(Projector& projector, StereoCamera& cameras, const Clock& clock, SessionObserver* observer)
        : projector_(projector, observer), cameras_(cameras, observer), clock_(clock, observer) {}
    ObservedDevices(const ObservedDevices&) = delete;
    ObservedDevices& operator=(const ObservedDevices&) = delete;

    Projector& projector() { return projector_; }
    StereoCamera& cameras() { return cameras_; }
    const Clock& clock() const { return clock_; }

    /// Darkness before the observer hears of anything.
    void darken_first() noexcept { projector_.darken_untold(); }

private:
    class ObservedProjector final : public Projector {
    public:
        ObservedProjector(Projector& device, SessionObserver* observer) : device_(device), observer_(observer) {}
        int width() const override { return device_.width(); }
        int height() const override { return device_.height(); }
        Instant show(const RgbImage& picture, Instant valid_until) override;
        void go_dark() noexcept override;
        void darken_untold() noexcept { device_.go_dark(); }

    private:
        Projector& device_;
        SessionObserver* observer_;
    };
    class ObservedCameras final : public StereoCamera {
    public:
        ObservedCameras(StereoCamera& device, SessionObserver* observer) : device_(device), observer_(observer) {}
        StereoFrame grab(Instant not_before, std::chrono::milliseconds patience) override;
        StereoFrame newest(Instant not_before, std::chrono::milliseconds patience) override;
        bool wait_until_exposed(Instant not_before, std::chrono::milliseconds patience) override;
        std::string doubt() const override;

    private:
        StereoCamera& device_;
        SessionObserver* observer_;
        mutable std::string told_doubt_;  ///< what the observer heard last
    };
    class ObservedClock final : public Clock {
    public:
        ObservedClock(const Clock& device, SessionObserver* observer) : device_(device), observer_(observer) {}
        Instant now() const override;

    private:
        const Clock& device_;
        SessionObserver* observer_;
    };
    ObservedProjector projector_;
    ObservedCameras cameras_;
    ObservedClock clock_;
};

}  // namespace planlight
