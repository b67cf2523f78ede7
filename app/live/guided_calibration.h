#pragma once

#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "projection/guide_light.h"
#include "registration/calibration/calibrate_rig.h"
#include "registration/calibration/pose_guide.h"
#include "registration/scan/scan_surface.h"

namespace planlight {

struct GuidedSettings {
    PoseGuideSettings guide;
    std::filesystem::path captures;  ///< folder for every pose's pictures, as `calibrate` reads them; empty: not kept
    DeviceSerials serials;           ///< for those folders
    Instant light_later{};           ///< to wait for each picture beyond what the projector promises, at first
    Instant camera_patience = std::chrono::seconds(20);  ///< for cameras or a projector that fail to come back
};

/// What happened, as it happens.
struct GuideEvent {
    enum class Kind { advice, refused, capturing, captured, predicted, trouble, done } kind = Kind::advice;
    Instant at{};                        ///< since the beginning
    PoseFault fault = PoseFault::none;   ///< of advice and refusals by the pose
    std::string why, what;               ///< sentences; may be empty
    std::size_t poses = 0;               ///< that count so far; of `predicted`: that it was made of
    std::optional<double> predicted_mm;  ///< 95 % of the working volume, by the poses so far
};

/// For a window: all that a person should see now.
struct GuideState {
    enum class Step { watching, capturing, looking } step = Step::watching;
    std::shared_ptr<const GrayImage> left, right;
    BoardCorners left_corners, right_corners;
    PoseAdvice advice;
    PoseCoverage coverage;
    std::vector<std::string> wanted;
    GuideLight light;
    double step_share = 0;                    ///< 0 to 1
    std::string trouble, trouble_remedy;      ///< with a device; empty: none
    std::string given_up_why, given_up_what;  ///< of the capture that came to nothing here; empty: none did
    std::size_t poses = 0, least_poses = 0, most_poses = 0;
    std::optional<double> predicted_mm;
    double good_enough_mm = 0;
    double useful_tilt = 0;  ///< radians, of PoseGuideSettings
};

/// A calibration by hand: a person carries the board about, the program watches both live pictures, says what to do,
/// captures by itself when the board is right and at rest, and ends when the predicted error is good enough.
class GuidedCalibration {
public:
    GuidedCalibration(Projector& projector, StereoCamera& cameras, const Clock& clock, const BoardSpec& board,
                      const GuidedSettings& settings, std::function<void(const GuideEvent&)> tell);

    /// Until there are poses enough, or it is asked to stop. The projector is dark afterwards. Throws DeviceError when
    /// a device fails and does not come back.
    void run(const std::stop_token& stop);

    /// The calibration of all poses so far, judged on held-out ones; may be refused.
    Calibration calibrate() const;
    const std::vector<PoseObservation>& poses() const { return poses_; }
    std::size_t refused_poses() const { return refused_; }  ///< boards at rest that were sent on, with the reason

    GuideState state() const;  ///< from any thread

private:
    void look();
    void say(const PoseAdvice& advice);
    void shine(const GuideLight& light);
    void capture(const BoardSighting& sighting);
    ScanCapture take_pictures(const BoardSighting& sighting);
    PoseObservation observe(const ScanCapture& pictures) const;
    void refuse_bad(const PoseObservation& pose, const BoardSighting& sighting);
    void give_up(PoseFault fault, const std::string& why, const std::string& what);
    void keep_pose(PoseObservation pose);
    bool moved_since(const BoardSighting& before);
    void keep_pictures(const ScanCapture& capture) const;
    void estimate();
    void collect_estimate();
    void tell(GuideEvent::Kind kind, PoseFault fault, const std::string& why, const std::string& what);
    void set_step(GuideState::Step step, double share);

    Projector& projector_;
    StereoCamera& cameras_;
    const Clock& clock_;
    BoardSpec board_;
    GuidedSettings settings_;
    std::function<void(const GuideEvent&)> tell_;
    StripeSettings stripes_;
    PoseGuide guide_;
    std::vector<PoseObservation> poses_;
    std::future<Calibration> estimate_;
    std::size_t estimated_poses_ = 0, refused_ = 0;
    std::optional<double> predicted_mm_;
    Instant later_{}, began_{}, seen_at_{}, shone_at_{}, not_before_{};
    GuideLight light_;
    std::stop_token stop_;
    PoseFault told_ = PoseFault::none;
    std::string told_what_;
    bool refused_here_ = false;  ///< the board has not moved since it was refused or captured
    mutable std::mutex mutex_;
    GuideState state_;
};

}  // namespace planlight
