#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/room_kind.h"
#include "planning_io/types/image.h"
#include "planning_io/types/point_cloud.h"
#include "planning_io/types/rigid_transform.h"
#include "planning_io/types/triangle_mesh.h"
#include "projection/draw_plan.h"
#include "projection/skin_surface.h"

namespace planlight {

inline constexpr double kStickerRadius_mm = 8;  ///< of a marker, round its disc

/// A marker's disc on the skin, as the 3-D view shows it.
struct SceneMarker {
    Eigen::Vector3d p_in_ct;
    Eigen::Vector3d normal_in_ct = Eigen::Vector3d::Zero();  ///< outward, unit; zero: away from the head's middle
    bool seen = true;                                        ///< false is drawn grey
};

/// Light as it falls on the skin: a stroke cast again for the pose it was drawn for.
struct LightLine {
    std::vector<Eigen::Vector3d> points_in_ct;
    bool closed = false;
};

/// What the 3-D view shows, all of it in ct (LPS, mm). Every part may be null.
///
/// The shared parts are taken as unchanging: to show another one, hand over another pointer. What has the same pointer
/// as in the last frame is not built again.
struct SceneModel {
    std::shared_ptr<const TriangleMesh> skin;
    bool on_paper = false;  ///< white behind, dark and larger letters: for pages that are printed
    bool of_scan = false;   ///< `skin` is a scan's surface in a frame of its own: cool colour, no letters at the edges
    std::shared_ptr<const PointCloud> cloud;
    std::shared_ptr<const std::vector<float>> cloud_distance_mm;  ///< per point, to the skin; null: one colour
    RigidTransform ct_from_rig = RigidTransform::Identity();      ///< where the cloud is shown
    std::shared_ptr<const std::vector<SceneMarker>> markers;
    std::shared_ptr<const PlanDrawing> plan;
    std::shared_ptr<const std::vector<LightLine>> light;  ///< drawn white, above the plan
    /// Seen through the skin, each in a colour of its own; named in the legend.
    std::shared_ptr<const std::vector<RiskStructure>> risk_structures;
    double skin_offset_mm = 0;         ///< the distances are counted from this far outside of the CT's skin
    double largest_distance_mm = 1.5;  ///< the red end of the colour scale
    /// Per vertex of the skin, how far off it may be (95 %), mm; null: the skin has its own colour.
    std::shared_ptr<const std::vector<float>> skin_error_mm;
    int bright_item = -1;                         ///< of the plan: the others are dim; -1: none is
    double warn_above_mm = 1, stop_above_mm = 2;  ///< its colours: green, amber above, red above

    bool operator==(const SceneModel& other) const;
};

/// What the 3-D view shows of a match.
enum class FitView { after, before, predicted_error };

/// What the 3-D view needs of a match beyond the scan as it lies after the fine match (which the scene has).
struct FitViews {
    RigidTransform before_ct_from_rig = RigidTransform::Identity();  ///< of the initial match
    std::shared_ptr<const std::vector<float>> before_distance_mm;    ///< per point of the cloud
    std::shared_ptr<const std::vector<float>> predicted_mm;          ///< per vertex of the skin, 95 %

    bool operator==(const FitViews& other) const;
};

/// A scan as a surface to be clicked on, in a frame `shown` in which it is looked at as a face is in ct: x to the
/// devices' right, y away from them, z up.
struct ClickableScan {
    SkinSurface surface;  ///< in `shown`
    RigidTransform shown_from_rig = RigidTransform::Identity();
};

/// What landmarks can be clicked on: the skin from CT and the scan.
struct LandmarkViews {
    const SkinSurface* skin = nullptr;  ///< outlives the frames that show it
    std::shared_ptr<const ClickableScan> scan;

    bool operator==(const LandmarkViews&) const = default;
};

/// From where the head is looked at. Turning never tilts it: S stays up, but where a view of its own is asked for (the
/// projector's, the surgeon's).
struct SceneView {
    double azimuth = 0.44;    ///< radians; 0 = from the front (anterior), positive = from the patient's right
    double elevation = 0.28;  ///< radians, positive = from above; at most a quarter turn
    double roll = 0;          ///< radians, of the viewer's head to the left
    double zoom = 1;          ///< 1 = the skin fills the view
    Eigen::Vector2d shift_mm = Eigen::Vector2d::Zero();  ///< of the picture's middle, along the view's right and up

    bool operator==(const SceneView&) const = default;
};

/// A place on the skin, for a person to look at; in ct, mm.
struct LookAt {
    Eigen::Vector3d p_in_ct;
    Eigen::Vector3d from_in_ct;  ///< the way from there to the eye, unit, from which nothing hides it (`free_view_of`)

    bool operator==(const LookAt&) const = default;
};

/// Of a step in the list of the session's steps; `attention` wants the operator before it goes on.
enum class StepState { waiting, active, done, attention };

/// A found disc in a camera picture, pixels of that picture.
struct FoundMarker {
    Eigen::Vector2d pixel;
    double radius_px = 0;
    enum class Pairing { both, alone, not_asked };
    Pairing pairing = Pairing::both;  ///< whether both cameras have it, or this one alone

    bool operator==(const FoundMarker&) const = default;
};

/// A picture and what was found in it.
struct SeenPicture {
    std::shared_ptr<const GrayImage> picture;  ///< another pointer = another picture; null = none
    std::vector<FoundMarker> found;
    bool searched = true;  ///< for markers; false: nobody looked

    bool operator==(const SeenPicture&) const = default;
};

struct CameraPicture {
    std::string title;  ///< "Left camera"
    SeenPicture live;   ///< the newest
    /// Whole seconds since it was taken, when that is too long for it to be called live; 0: it is live.
    int old_s = 0;
    std::string note;  ///< why there is no picture, or no newer one
    /// The picture that a refusal came from; shown in place of the live one until the person presses on it.
    std::optional<SeenPicture> refused;

    bool operator==(const CameraPicture&) const = default;
};

/// A plan item in the table. Values in mm; empty is shown as a dash.
struct PlanRow {
    Rgb colour{255, 255, 255};
    std::string name;  ///< "B1  ⌀7  6 mm deep"
    std::optional<double> depth_mm, predicted_error_mm, light_off_mm;
    Clearances risk = {};         ///< to risk structures, what is worst first: all that warn, or else the nearest
    bool hidden = false;          ///< by a person: not lit, not in the 3-D view
    std::string short_name = {};  ///< "B1  ⌀7": in the table, where the depth has a column; empty: the name
    bool bare = false;            ///< no name stands beside its light: the plan is crowded

    bool operator==(const PlanRow&) const = default;
};

/// What the banner says; only `aligned` is green, and `dark` is the operator's or the gate's.
enum class StatusKind { ready, scanning, matching, aligned, check, refused, dark, waiting };

struct Status {
    StatusKind kind = StatusKind::dark;
    std::string headline;              ///< one sentence: may the light be trusted, or why not
    std::vector<std::string> details;  ///< further sentences
    std::optional<double> share = {};  ///< 0 to 1: how far it is, of what is being done; empty: no bar

    bool operator==(const Status&) const = default;
};

/// Shown beside the status; empty is shown as a dash.
struct Figures {
    std::optional<double> overlay_error_mm, updates_per_s, head_moved_mm, head_turned_deg, delay_to_light_ms;

    bool operator==(const Figures&) const = default;
};

struct ButtonState {
    bool enabled = false;
    std::string why_not;  ///< a few words, shown in the button while it is not enabled: "scan first"

    bool operator==(const ButtonState&) const = default;
};

/// What the operator pressed, by mouse, key or pedal.
enum class OperatorAction {
    none,
    scan,
    do_register,
    track,
    stop,
    dark,
    quit,
    confirm,
    use_landmarks,
    check_skin,
    light_item,
    hide_item,
    show_item
};

/// All that the operator window shows, as values: the window draws it and knows nothing else.
struct OperatorModel {
    std::string case_title;               ///< whose head: the patient, as the site names them
    std::string case_plan;                ///< plan, its version, date of the series
    std::string case_subtitle;            ///< further words
    std::string case_side;                ///< "RIGHT", in large letters; empty: not known
    RoomKind room_kind = RoomKind::real;  ///< nothing is real: said in large letters
    std::array<StepState, 6> steps{};     ///< Case, Rig, Scan, Match, Verify, Project
    SceneModel scene;
    std::optional<LandmarkViews> landmarks;  ///< there is a scan: landmarks can be clicked on it
    std::optional<FitViews> fit;             ///< there is a match to be looked at: the 3-D view gets buttons for it
    CameraPicture left{"Left camera", {}, 0, "no picture yet", {}};
    CameraPicture right{"Right camera", {}, 0, "no picture yet", {}};
    std::vector<PlanRow> rows;
    double warn_above_mm = 1;           ///< a larger error in the table is amber and marked
    double stop_above_mm = 2;           ///< a larger one red and marked
    std::vector<std::string> evidence;  ///< what the registration was judged by, in words
    Status status;
    Figures figures;
    ButtonState scan, do_register, track, stop;   ///< DARK is always enabled
    std::string use_landmarks = "Use landmarks";  ///< on the button that hands over the landmarks that were clicked
    bool check_skin = false;                      ///< a short scan may be asked for: a button over the 3-D view
    bool confirm = false;  ///< the match, or its light, needs a person's look: a button says that it is right
    std::string confirm_words = "It fits: use it";  ///< on that button
    OperatorAction next = OperatorAction::none;     ///< what leads on: its button stands out; none: nothing does
    std::optional<std::size_t> item_of_moment;      ///< row whose light alone is bright; empty: all of the plan
    bool may_light_item = false;    ///< there is a match: an item of the moment may be chosen, items may be hidden
    std::optional<LookAt> look_at;  ///< what a person is asked to look at in the 3-D view
    std::optional<SceneView> surgeon_view;    ///< as the surgeon stands; empty: not known
    std::optional<SceneView> projector_view;  ///< as the light falls; empty: not known yet
    bool light_on = false;                    ///< light may be on the patient: closing the window asks first
    bool light_stays = false;                 ///< it was put out, and the cameras still see it: `status` says so

    bool operator==(const OperatorModel&) const = default;
};

/// The scene as that view shows it. Without a match it is the scene as it is. After the match, without the scan while a
/// person is asked to look at a place.
SceneModel scene_of_fit(const OperatorModel& model, FitView view);

}  // namespace planlight
