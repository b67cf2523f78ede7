#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/kept_match.h"
#include "app/observed_devices.h"
#include "planning_io/case/case_folder.h"
#include "planning_io/types/registration_result.h"
#include "planning_io/types/rig_calibration.h"
#include "projection/check_light.h"
#include "projection/darkness_check.h"
#include "projection/light_brightness.h"
#include "projection/light_watch.h"
#include "projection/overlay_loop.h"
#include "registration/matching/register_with_landmarks.h"
#include "registration/scan/scan_surface.h"
#include "registration/tracking/picture_jumps.h"
#include "registration/tracking/track_patient.h"

namespace planlight {

enum class SessionCall;

struct SessionSettings {
    ScanSettings scan;
    RegistrationSettings registration;
    TrackingSettings tracking;
    OverlaySettings overlay;
    CheckLightSettings check_light;
    int check_light_every = 2;  ///< updates; 0: the light is not measured
    LightCauseSettings light_cause;
    /// Light that comes later than told is drawn ahead by so much at most; 0: it is said only.
    std::chrono::milliseconds most_delay_corrected{60};
    double max_motion_in_scan_mm = 0.15;  ///< of any marker between two moments of a scan; above: the scan is repeated
    int max_scans = 3;                    ///< so often at most, then refused
    double max_motion_in_skin_check_mm = 0.3;  ///< of any marker during a check of the skin; above: no answer
    ResumeSettings resume;
    /// From the beginning of the last light until a frame that still shows it tells of a projector that does not go
    /// out.
    std::chrono::milliseconds time_to_dark{500};
    int min_reference_markers = 5;  ///< found in both pictures at the scan
    std::chrono::milliseconds patience{1000};
    /// While following: without a pair of frames for so long, or for three frame intervals where that is more, the
    /// camera is named.
    std::chrono::milliseconds follow_patience{200};
    /// Called between seeing and showing, so that a simulated clock can be told how long the computing took. May be
    /// empty.
    std::function<void()> while_computing;
    SessionObserver* observer = nullptr;  ///< told of all that goes in and comes out; null: nobody
};

/// The settings of a session on a patient with such markers.
SessionSettings settings_for(const MarkerDesign& markers);

/// The drawing machinery of one case: made once, used by every picture.
struct CaseDrawing {
    SkinSurface skin;
    DrawingSettings settings;
    PlanDrawing drawing;  ///< as it is before any marker is known; a session moves the labels off its markers
    explicit CaseDrawing(const Case& the_case, const DrawingSettings& settings = {});
    /// On the skin as the scan found it; `planned` is the case's own. Warns of what the scan did not see.
    CaseDrawing(const Case& the_case, const CaseDrawing& planned, const SkinDisplacement& found);
    /// The same, drawn otherwise.
    CaseDrawing(const Case& the_case, const CaseDrawing& planned, const SkinDisplacement& found,
                const DrawingSettings& how);

private:
    CaseDrawing(const Case& the_case, const CaseDrawing& planned, const SkinDisplacementField& found,
                const DrawingSettings& how);
};

/// How a plan is drawn for a head found at this pose: labels where this rig's light can reach all of them, upright as
/// the settings say, or as the left camera sees them.
DrawingSettings lit_by(const RigCalibration& rig, const RigidTransform& rig_from_ct, DrawingSettings settings);

/// Where the skin lies against where the markers put it, by a short scan.
struct SkinCheck {
    bool known = false;
    bool elsewhere = false;   ///< where the markers do not put it, by more than this scan can say; then it is not known
    std::string why_not;      ///< why it is not known, in words
    std::size_t points = 0;   ///< of skin, scanned
    double off_mm = 0;        ///< of the plan's point that lies farthest off
    double bound_mm = 0;      ///< how far off the scan itself may be there, 95 %
    std::size_t on_skin = 0;  ///< points that lie over skin where the markers put it,
    double residual_mm = 0;   ///< and how far off it, median
    double moved_meanwhile_mm = 0;
};

/// The times of one tracked update: the product's own work.
struct UpdateTimes {
    double track_s = 0, draw_s = 0, check_s = 0;
    double total_s() const { return track_s + draw_s + check_s; }
};

/// One session with one patient: scan, find, follow, draw (Hoppe 2001, 2.2). Devices and clock are real, recorded or
/// simulated; the projector is dark whenever nothing else is asked of it, and on every way out.
class Session {
public:
    Session(const Case& the_case, const CaseDrawing& drawing, const RigCalibration& rig, Projector& projector,
            StereoCamera& cameras, const Clock& clock, SessionSettings settings = {});
    ~Session();

    /// SCAN: shows the stripes, makes the cloud, takes the markers of the first picture as reference. Repeats it when
    /// the patient moved (the markers are looked at in every picture that is even light when summed with its inverse,
    /// and once more under white light at the end). Throws CheckFailedError when the patient did not lie still in
    /// `max_scans` scans, too few markers were found, or the rig moved so that it cannot be trusted. Cloud, poses and
    /// light are made with the rig as this scan finds it.
    const ScanResult& scan(const std::function<void(int, int)>& progress = {});

    /// MATCH: T_ini from the last scan; landmarks check it, and help where it is refused (`register_with_landmarks`).
    /// Throws CheckFailedError without a scan.
    const RegistrationResult& find_patient(const std::vector<PointPair>& landmarks = {});

    /// The operator's word that the match was looked at (needed for the verdict `ask`). It holds for the last match
    /// only, through darkness too.
    void confirm();

    /// TRACK and DRAW once: a frame, its pose T_cur, the picture for T_global = T_cur T_ini or darkness.
    /// Throws CheckFailedError when the patient was not found yet.
    struct Update {
        StereoFrame frame;
        TrackedPose pose;
        OverlayStep overlay;
        UpdateTimes times;
        Instant received_at{};  ///< when the frame was there, on the session's clock
        Instant swapped_at{};   ///< when the picture was on the display; 0: dark
        /// The light of the picture before, as this frame shows it; empty where it was not looked at, or not lit for
        /// the whole exposure.
        std::optional<LightCheck> light;
        /// It is dark, or other light is on, and what was lit before is still seen (`Session::light_stays`).
        bool light_stays = false;
        std::string camera_doubt;        ///< what is wrong with the cameras though frames come; empty: nothing
        std::vector<LightCause> causes;  ///< of light that is not where it belongs, likeliest first; empty: none
    };
    Update update();

    /// The short scan: some 15 pictures (a second), columns only, laid on the skin from CT as the match was. Sees what
    /// the light's own check cannot: markers that moved on the head all together, a head that slid under its cap. The
    /// projector is dark afterwards until the next `update`. Throws CheckFailedError without a match, DeviceError.
    SkinCheck check_skin(const std::function<void(int, int)>& progress = {});

    /// Goes on with a match of another session, or of this one after its devices were away, if markers, rig and skin
    /// still agree with it: a short scan of columns and rows, then as after `find_patient`. Whatever does not agree
    /// throws CheckFailedError that says what; then there is no match, and it is dark. What of the plan is lit is as
    /// the match was kept with. Throws DeviceError.
    ResumeCheck resume(const KeptMatch& match, const std::function<void(int, int)>& progress = {});
    /// The match of now, for `resume`; empty without one that may be used. The caller says when it was made.
    std::optional<KeptMatch> kept_match() const;

    /// Places at which a person can judge the light (`landmarks_to_verify`) of the head as it was last seen, found anew
    /// for each match, and once the plan was lit again after them; ct, mm.
    const std::vector<Eigen::Vector3d>& landmarks();
    /// From the next `update` on this landmark alone is lit, as a ring with a cross; empty: the plan.
    void light_landmark(std::optional<std::size_t> which);
    /// From the next `update` on this item of the plan is bright, with its label, and the others are dim
    /// (`RenderSettings::others`); the light is measured on it alone. Empty: all are bright.
    void light_item(std::optional<std::size_t> which);
    std::optional<std::size_t> item_of_moment() const { return item_of_moment_; }
    /// From the next `update` on this item of the plan is neither lit nor looked for. Until it is shown again, lit
    /// alone, or the next match; landmarks are lit as ever. With all items hidden it is dark, and says so.
    void hide_item(std::size_t which);
    /// It is lit again. Empty: the whole plan is, and none is the item of the moment.
    void show_item(std::optional<std::size_t> which);
    const std::set<std::size_t>& hidden_items() const { return hidden_; }
    /// The card with the patient's name and side (`DrawingSettings::card`) is lit with the plan from the match until a
    /// landmark has been lit, also where the match was gone on with meanwhile.
    bool card_wanted() const { return card_wanted_ && lit_drawing().card; }
    /// For `KeptMatch::lit`.
    LitPart lit_part() const { return {hidden_, item_of_moment_, card_wanted_}; }
    bool all_hidden() const { return !hidden_.empty() && hidden_.size() == drawing().items.size(); }
    /// What is lit: the plan without its hidden items, or the landmarks.
    const PlanDrawing& lit_drawing() const {
        return lit_landmark_ ? landmark_drawing_ : without_hidden_ ? *without_hidden_ : drawing();
    }

    /// Between updates: whether the last light, put out `SessionSettings::time_to_dark` ago or longer, is seen in this
    /// frame and in one before it (`DarknessCheck`); or what was lit before that and was never seen to go. False where
    /// nothing was lit since a projector's stripes were seen on the skin.
    bool light_stays(const StereoFrame& frame);

    /// How much later than told the light of this match was found to be; it is drawn ahead by that.
    Instant found_delay() const { return found_delay_; }

    /// Dark now, and no more light until the next `update`.
    void go_dark() noexcept;

    const Plan& plan() const { return case_.plan; }
    /// The rig as the last scan found it, and as it was calibrated before the first.
    const RigCalibration& rig() const { return rig_; }
    const RigState* rig_state() const { return rig_state_ ? &*rig_state_ : nullptr; }
    const ScanCapture* capture() const { return capture_ ? &*capture_ : nullptr; }
    const ScanResult* scanned() const { return scanned_ ? &*scanned_ : nullptr; }
    const RegistrationResult* registration() const { return registration_ ? &*registration_ : nullptr; }
    const PatientTracker& tracker() const { return tracker_; }
    const TrackingSettings& tracking_settings() const { return settings_.tracking; }
    const DrawingRenderer& renderer() const { return *renderer_; }
    /// The plan as this session draws it, on the skin as the scan found it: labels lie beside the markers, so that none
    /// is cut by the darkness round them.
    const PlanDrawing& drawing() const { return now_ ? now_->drawing : planned_.drawing; }
    const RenderSettings& render_settings() const { return settings_.overlay.render; }
    double motion_in_scan_mm() const { return motion_in_scan_mm_; }
    int scans_repeated() const { return scans_repeated_; }  ///< in the last `scan`, because the patient moved

private:
    template <class Do>
    void told(SessionCall call, const Do& body, const std::vector<PointPair>& landmarks = {}, int which = -1);
    std::function<void(int, int)> told_when_stopped(const std::function<void(int, int)>& progress) const;
    void make_scan(const std::function<void(int, int)>& progress);
    void match(const std::vector<PointPair>& landmarks);
    Update make_update();
    SkinCheck measure_skin(const std::function<void(int, int)>& progress);
    ResumeCheck take_up(const KeptMatch& match, const std::function<void(int, int)>& progress);
    RigidTransform compare_room(const KeptMatch& match, const std::function<void(int, int)>& progress,
                                ResumeCheck& check);
    void compare_skin_again(const KeptMatch& match, const RigidTransform& rig_from_patient, ResumeCheck& check) const;
    void darken() noexcept;
    [[noreturn]] void refuse_scan_without_skin();
    void use_rig(const RigCalibration& rig);
    StereoFrame next_frame();
    void name_lost_pose(Update& update);
    void name_hidden_plan(Update& update) const;
    void set_hidden(std::set<std::size_t> hidden);
    void light_part(const LitPart& part);
    std::size_t reference_markers(const ScanCapture& capture);
    void take_reference(const ScanCapture& capture);
    void take_rig(const ScanCapture& capture);
    double moved_at_the_end_mm();
    void draw_on_skin_as_found();
    void start_overlay();
    std::optional<LightCheck> look_at_light(const Update& update);
    TrackedPose pose_under_white();
    const SkinSurface& skin_of_light() const { return now_ ? now_->skin : planned_.skin; }
    void watch_light(Update& update);
    void note_shown(const OverlayStep& overlay);
    struct LitLight;
    std::vector<std::size_t> put_out_since(const LitLight& former) const;
    LightPutOut put_out(const LitLight& former, bool dark, const RigidTransform& rig_from_ct) const;
    bool sees_last_light(const StereoFrame& frame, bool dark,
                         const std::function<std::optional<RigidTransform>()>& find_patient);
    void note_lit(const OverlayStep& overlay);
    void note_seen(const LightCheck& check, Instant at);
    void forget_last_light();
    void correct_delay(std::vector<LightCause>& causes);

    const Case& case_;
    const CaseDrawing& planned_;
    std::shared_ptr<const CaseDrawing> now_;  ///< on the skin as the last match found it
    const RigCalibration calibrated_;         ///< rig.json
    RigCalibration rig_;                      ///< as the last scan found it: cloud, poses and light are made with it
    std::optional<RigState> rig_state_;
    ObservedDevices devices_;
    Projector& projector_;
    StereoCamera& cameras_;
    const Clock& clock_;
    SessionSettings settings_;
    PatientTracker tracker_;
    std::unique_ptr<DrawingRenderer> renderer_;
    std::optional<ScanCapture> capture_;
    std::optional<ScanResult> scanned_;
    std::optional<RegistrationResult> registration_;
    std::unique_ptr<OverlayLoop> overlay_;
    std::optional<LightChecker> checker_;
    std::optional<LightWatch> watch_;
    std::optional<PictureJumps> jumps_;
    LightBrightness brightness_;
    /// What the checker looks for: what is lit, or the one item that is bright.
    std::shared_ptr<const PlanDrawing> looked_for_;
    std::optional<std::size_t> bright_item_;
    struct LitLight {
        Instant lit_from{};
        RigidTransform rig_from_ct;
        RigidTransform patient_from_ct;  ///< of the match that it was lit by,
        int reference = 0;               ///< and `references_` then: whose frame patient is
        std::shared_ptr<const PlanDrawing> drawing;
        std::optional<std::size_t> bright_item;
        bool landmark = false;
        std::shared_ptr<const CaseDrawing> on;  ///< whose skin it is drawn on; empty: `planned_`
        RigCalibration rig;
        double grey = 0;  ///< `light_grey`; 0: it was not looked at
        /// Where the head stood for the picture that was last seen in its place: the one that stays where none after
        /// it reached the skin. Empty: none was seen yet.
        std::optional<RigidTransform> rig_from_ct_seen;
        /// For the last picture ordered, and for the last one seen; made when they are first looked for.
        std::unique_ptr<DarknessCheck> check, check_of_seen;
        bool lights(std::size_t item) const;  ///< in full
        bool still_seen() const;              ///< by the last look
        bool gone() const;
        void look_anew();  ///< other light is out now, or it lies elsewhere
    };
    /// What was ordered last, also through another match; and what was lit before that, until it was seen to go. Empty:
    /// none, or a projector's stripes were seen since.
    std::optional<LitLight> last_light_, former_light_;
    Instant changed_at_{};  ///< from the one to the other
    double lit_grey_ = 0;   ///< of what the overlay lights, as it was seen last
    int references_ = 0;    ///< how often the tracker was given one
    Instant darkness_looked_at_{};
    std::vector<ShownPicture> shown_;
    RenderCounts counts_shown_;  ///< of the last picture
    Instant found_delay_{};
    Instant seen_until_{};                  ///< end of the last exposure that was used
    Instant seen_at_{}, frame_interval_{};  ///< its middle, and between two; 0: not known
    int lost_poses_ = 0;                    ///< in a row
    bool exchanged_ = false;                ///< the cameras, when that was last looked at
    std::optional<std::vector<Eigen::Vector3d>> landmarks_;
    RigidTransform rig_from_patient_ = RigidTransform::Identity();  ///< by the last good pose since the scan
    PlanDrawing landmark_drawing_;
    std::optional<std::size_t> lit_landmark_, item_of_moment_;
    std::set<std::size_t> hidden_;               ///< items of the plan
    std::optional<PlanDrawing> without_hidden_;  ///< the drawing without them; empty where there are none
    Instant lit_since_ = Instant::max();         ///< light without a break; max: it is dark
    int updates_ = 0;
    bool confirmed_ = false;    ///< the last match, by the operator
    bool card_wanted_ = false;  ///< nobody has looked at a landmark of this match yet
    double motion_in_scan_mm_ = 0;
    int scans_repeated_ = 0;
};

}  // namespace planlight
