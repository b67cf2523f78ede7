#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/camera_model.h"
#include "planning_io/types/time.h"
#include "projection/check_light.h"

namespace planlight {

/// What is wrong when light is not where it belongs, or is not seen.
enum class LightFault {
    late_picture,        ///< light comes later than the projector promises
    projector_moved,     ///< it was knocked, or its picture shifted
    left_camera_moved,   ///< since the scan
    right_camera_moved,  ///< the same
    marker_slipped,      ///< one of them, against the others
    markers_moved,       ///< all together against the skin
    no_picture,          ///< the projector shows none, or its lens is covered
    other_picture,       ///< it shows something else: another window
    partly_covered,      ///< something is before a part of the light, or of a camera's view
    light_off,           ///< light lies aside as none of these would lay it
};

/// A picture that was shown: when it was to be light, and the T_global it was drawn for.
struct ShownPicture {
    Instant lit_from{};
    RigidTransform rig_from_ct = RigidTransform::Identity();
};

/// What one frame told that a cause can be read from.
struct LightFacts {
    Instant at{};       ///< mid-exposure
    bool pose = false;  ///< the markers gave one; without it nothing of the light is known
    RigidTransform rig_from_ct = RigidTransform::Identity();  ///< of the head at `at`, by the markers
    std::vector<SeenSegment> segments;                        ///< of CHECK; empty where it did not look
    int expected = 0, seen = 0;                               ///< of CHECK
    std::optional<double> far_mm;                             ///< of CHECK
    double background = 0;                                    ///< of CHECK
    std::vector<ShownPicture> shown;                          ///< the last ones, oldest first
    /// How far the discs of the left and the right picture went together beyond even movement, mm at their depth;
    /// empty where that is not known (`PictureJumps`).
    std::array<std::optional<double>, 2> jump_mm;
    int slipped_marker = -1;  ///< which the pose was made without; -1: none
    double slipped_mm = 0;
};

struct LightCauseSettings {
    Instant window = std::chrono::milliseconds(600);        ///< that light beside its place is judged over
    Instant long_window = std::chrono::milliseconds(2500);  ///< a delay takes movement to be seen: it may have so long
    Instant least = std::chrono::milliseconds(350);         ///< a fault must show for so long
    int least_checks = 3;
    double least_off_mm = 0.25;  ///< of the light as a whole; less is what calibration and skin leave
    double least_delay_s = 0.008, most_delay_s = 0.1, delay_step_s = 0.002;
    double least_effect_mm = 0.12;  ///< of a delay on the light: at rest none is seen
    double least_jump_mm = 0.2;     ///< of one camera's discs, and the other's at most `other_jump` times that
    double other_jump = 0.35;
    double least_depth_mm = 0.5;  ///< of the skin off where the markers put it
    double least_slip_mm = 0.4;
    double unseen_share = 0.1, covered_share = 0.5;  ///< of the stretches seen; less is no light, or a part of it
    double brighter = 1.15, brighter_grey = 6;       ///< than usual beside the strokes: another picture
};

/// A cause with its size, likeliest first.
struct LightCause {
    LightFault fault = LightFault::light_off;
    double size = 0;             ///< ms of a late picture; else mm on the skin; share seen of light that is not seen
    double low = 0, high = 0;    ///< of a delay, ms: all in between explain the frames alike
    int marker = -1;             ///< that slipped
    double share = 0;            ///< of what is unexplained, explained; 1 where it is seen directly
    bool light_is_wrong = true;  ///< false: it is noticed and dealt with, and the light lies where it belongs
    bool drawn_ahead = false;    ///< of a late picture: the next ones are drawn for the moment when they will be light
    std::string headline() const;  ///< a few words for the banner
    std::string sentence() const;
    std::string remedy() const;
};

/// The causes that the frames of the last seconds speak for, by the pattern of what they show: light that goes with the
/// head's velocity is late; that is turned as one about the projector, the projector has moved; where one camera's
/// discs have jumped as well, that camera; light at another depth than the skin by the markers, the markers have moved;
/// none at all is no picture. Empty while all is well.
///
/// `facts`, oldest first, at most some seconds. `usual_background`: grey beside the strokes while light was seen (0:
/// not known). Pure: the same facts give the same causes.
std::vector<LightCause> find_causes(const std::vector<LightFacts>& facts, const RigCalibration& rig,
                                    double usual_background, const LightCauseSettings& settings = {});

}  // namespace planlight
