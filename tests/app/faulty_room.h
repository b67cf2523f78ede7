#pragma once

#include <chrono>
#include <functional>
#include <random>
#include <string>

#include "app/session.h"
#include "registration/simulation/simulated_rig.h"

namespace planlight::test {

/// Shows the picture shifted, cut off at a line, or something else instead.
class SpoiltProjector final : public Projector {
public:
    explicit SpoiltProjector(Projector& projector) : projector_(projector) {}
    int width() const override { return projector_.width(); }
    int height() const override { return projector_.height(); }
    Instant show(const RgbImage& picture, Instant valid_until) override;
    void go_dark() noexcept override { projector_.go_dark(); }

    Eigen::Vector2d shift_px{0, 0};
    std::optional<RgbImage> instead;
    /// Nothing is lit where a pixel lies on the far side of this line: covered there.
    std::optional<Eigen::Hyperplane<double, 2>> covered_beyond;

private:
    Projector& projector_;
};

/// What cameras that were not chosen for measuring make of a picture, in this order; as they come: nothing.
struct CameraHabits {
    double blur_px = 0;     ///< sigma, beyond the lens's
    double sharpening = 0;  ///< share of the picture's difference from itself, blurred by 1.5 px, that is added
    double gamma = 1;       ///< grey values are raised to 1 / gamma
    double noise = 0;       ///< sigma, grey values
    int jpeg_quality = 0;   ///< 0: not compressed
};

/// Cameras with habits.
class SpoiltCameras final : public StereoCamera {
public:
    SpoiltCameras(StereoCamera& cameras, const CameraHabits& habits) : cameras_(cameras), habits_(habits) {}
    StereoFrame grab(Instant not_before, std::chrono::milliseconds patience) override;
    StereoFrame newest(Instant not_before, std::chrono::milliseconds patience) override;
    bool wait_until_exposed(Instant not_before, std::chrono::milliseconds patience) override {
        return cameras_.wait_until_exposed(not_before, patience);
    }
    std::string doubt() const override { return cameras_.doubt(); }

private:
    void spoil(GrayImage& picture, std::uint64_t seed) const;
    StereoCamera& cameras_;
    CameraHabits habits_;
};

/// A session in a simulated room in which things go wrong while the plan is on the skin. All chances come from the
/// room's seed.
class FaultyRoom {
public:
    /// From a frame to its picture the session computes for `computing`.
    FaultyRoom(const Volume& volume, const Case& the_case, const CaseDrawing& drawing,
               const simulation::RoomSettings& room, std::chrono::milliseconds computing,
               const CameraHabits& habits = {});

    /// Scans and matches, and takes a doubtful match for right. False: refused.
    bool find_patient();
    Session& session() { return session_; }
    simulation::SimulatedRig& rig() { return rig_; }
    /// The head moves at up to that, mm/s, from now on.
    void move(double speed_mm_s);

    struct Begun {
        std::function<void()> undo;
        std::string right;      ///< what it should be called; "nothing" where there is no fault
        Instant light_later{};  ///< so much later than told is light from now on
    };
    /// offset (the picture 0.5 mm aside), late (20 ms), slip (1 mm of one marker), cap (all markers 2 mm along the
    /// skin), projector and camera (turned by 0.05 degrees about an axis square to its sight), all `size` times as
    /// large; covered (no light), window (another picture), half (a part of the picture is covered), landmark (none,
    /// but one is lit as for Verify); what else it is called: none.
    Begun begin(const std::string& fault, double size = 1);

private:
    SessionSettings settings();
    Eigen::Vector3d any_axis();
    Eigen::Vector3d skin_normal(const Eigen::Vector3d& at) const;

    std::chrono::milliseconds computing_;
    std::mt19937 random_;
    simulation::SimulatedRig rig_;
    SpoiltProjector spoilt_;
    SpoiltCameras cameras_;
    Session session_;
    double speed_mm_s_ = 0;
    std::size_t landmark_ = 0;  ///< lit next
};

}  // namespace planlight::test
