#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/plan.h"
#include "planning_io/types/rig_calibration.h"
#include "planning_io/types/volume.h"
#include "registration/devices/projector.h"
#include "registration/devices/stereo_camera.h"
#include "registration/simulation/light.h"
#include "registration/simulation/room_things.h"

namespace planlight::simulation {

/// The two rooms every figure is given for.
enum class Preset {
    paper,   ///< projector 800x600 over 24x32 cm, two cameras 744x576
    modern,  ///< projector 1920x1080, two cameras 1920x1200
};

/// How the head moves during a session, as a function of simulated time.
struct Motion {
    double speed_mm_s = 0;  ///< greatest speed of the head's middle; 0 = at rest
    Instant begins{};       ///< at rest before
};

/// A room of the evaluation, all of whose chances come from `seed`.
struct RoomSettings {
    Preset preset = Preset::modern;
    unsigned seed = 1;                ///< of everything random: pose, noise, texture, calibration error, markers
    double skin_threshold_hu = -300;  ///< of the CT field that is the true skin
    int markers = 8;                  ///< asked for; fewer where the skin has no room
    Motion motion;
    double ambient = 0.2;          ///< of dimmed lamps: share of full scale on white skin
    double calibration_error = 1;  ///< scales the difference between true and calibrated rig (0 = perfect)
    Instant projector_delay = std::chrono::milliseconds(25);
    bool noise = true;
    LightSettings light;
    ThingsSettings things;  ///< drapes, hair, hands and instruments, at rest with the head; none by default
    double wet = 0;         ///< 0 dry to 1 dripping: how strong and how wide the highlights on the skin are
};

/// The simulated operating room: a true head (the CT field), a true projector, two true cameras and a clock of its own.
///
/// Shares no optics with the product. What the product may see: the devices, the clock and `calibration()`. What only
/// tests and the report may ask: everything in `Truth`.
class SimulatedRig {
public:
    /// Puts the patient of `volume` on the table in a random pose in front of the rig, with markers on the skin near
    /// `keep_clear_in_ct` but not on it (the plan's points; may be empty). Throws std::invalid_argument when no head
    /// surface is in the volume.
    SimulatedRig(const Volume& volume, const std::vector<Eigen::Vector3d>& keep_clear_in_ct,
                 const RoomSettings& settings);
    ~SimulatedRig();

    Projector& projector();
    StereoCamera& cameras();
    const Clock& clock() const;

    /// The rig as a calibration would have found it: truth plus the errors of a good calibration.
    const RigCalibration& calibration() const;

    /// Lets simulated time pass (the product's own computing time, for example).
    void wait(Instant duration);

    /// A lid before the projector's lens from now on, or taken away: not even the leak of a black picture comes out.
    void cover_projector(bool covered);

    /// Somebody presses Freeze on its remote control: it shows the picture of now for ever, whatever it is told.
    void freeze_projector();

    /// From now on the head moves so (its pose is continuous).
    void set_motion(const Motion& motion);

    /// Covers markers, so that no camera sees their discs (a hand, blood); by index, empty uncovers all.
    void cover_markers(const std::vector<int>& markers);

    enum class Device { left_camera, right_camera, projector };
    /// Somebody knocks a device: from now on it is turned (radians) and shifted (mm), both in its own axes (right,
    /// down, forward). `calibration()` does not know.
    void bump(Device device, const Eigen::Vector3d& turn, const Eigen::Vector3d& shift_mm = {0, 0, 0});

    /// A marker slips along the skin by about that much, ct; `marker` below 0: all of them, as when they sit on a cap.
    void slip_marker(int marker, const Eigen::Vector3d& shift_in_ct);

    /// The lamps are turned up or down: from now on they make white skin so bright, as a share of full scale at the
    /// exposure the room began with, and the cameras are exposed `exposure` times as long as then.
    void set_lamps(double ambient, double exposure = 1);

    /// From now on an order becomes light so much later than the projector promises.
    void delay_light(Instant untold);

    // ---- truth: nothing of the product reads what follows ----

    /// True `rig_from_ct` at a moment.
    RigidTransform true_rig_from_ct(Instant at) const;

    /// The true skin point nearest to a ct point, ct, mm (on the CT field itself).
    Eigen::Vector3d nearest_true_skin(const Eigen::Vector3d& p_in_ct) const;

    /// Distance of rig points (as scanned at `at`) to the true skin, mm, signed (positive outside).
    std::vector<double> scan_errors_mm(const std::vector<Eigen::Vector3d>& points_in_rig, Instant at) const;

    /// Where the light of a projector pixel (sub-pixel) falls on the true skin when the head is where it was at `at`:
    /// ct, mm, with the outward true normal. Empty when it misses the head.
    struct Lit {
        Eigen::Vector3d p_in_ct, normal_in_ct;
    };
    std::optional<Lit> true_light(const Eigen::Vector2d& pixel_in_projector, Instant at) const;

    /// The first true skin along a ray in ct (`direction` of unit length). Empty when it misses the head.
    std::optional<Lit> true_skin_along(const Eigen::Vector3d& origin_in_ct, const Eigen::Vector3d& direction) const;

    enum class Camera { left, right };
    /// What a camera pixel (sub-pixel) looks at when the head is where it was at `at`: the first true skin, ct, mm, and
    /// the projector pixel whose light falls there; empty where none does (shadow, turned away, beside the panel).
    struct Sight {
        Eigen::Vector3d p_in_ct, normal_in_ct;
        std::optional<Eigen::Vector2d> lit_by;
    };
    /// Empty when the pixel misses the head.
    std::optional<Sight> true_sight(Camera camera, const Eigen::Vector2d& pixel, Instant at) const;

    /// True when a camera sees this point of the true skin: in its picture and nothing before it.
    bool truly_seen(Camera camera, const Lit& skin, Instant at) const;

    /// Centres of the markers on the true skin, ct, mm.
    const std::vector<Eigen::Vector3d>& true_markers_in_ct() const;

    /// When every order to the projector became light, going dark included.
    const std::vector<TrueLight>& true_lights() const;

    /// The true rig (for reports of the calibration's error).
    RigCalibration true_rig() const;

    /// Everything above that is a number, as JSON text, for the truth file.
    std::string truth_json() const;

private:
    struct Room;
    std::unique_ptr<Room> room_;
};

}  // namespace planlight::simulation
