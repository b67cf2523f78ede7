// What a person is told of a cause.
#include <fmt/format.h>

#include "projection/light_cause.h"

namespace planlight {

std::string LightCause::headline() const {
    switch (fault) {
        case LightFault::late_picture:
            return size < 0 ? "the light comes early." : "the light comes late.";
        case LightFault::projector_moved:
            return "the projector has moved.";
        case LightFault::left_camera_moved:
            return "the left camera has moved.";
        case LightFault::right_camera_moved:
            return "the right camera has moved.";
        case LightFault::marker_slipped:
            return "a marker has slipped.";
        case LightFault::markers_moved:
            return "the skin is not where the markers put it.";
        case LightFault::no_picture:
            return "no light of the plan is seen.";
        case LightFault::other_picture:
            return "another picture or a lamp outshines the light.";
        case LightFault::partly_covered:
            return "a part of the light is covered.";
        case LightFault::light_off:
            return "the light lies aside.";
    }
    return {};
}

std::string LightCause::sentence() const {
    const std::string aside = size > 0 ? fmt::format(": the light lies {:.1f} mm aside", size) : "";
    switch (fault) {
        case LightFault::late_picture:
            if (size < 0) return fmt::format("The light comes {:.0f} ms earlier than the projector promises.", -size);
            return fmt::format(
                "The light comes {} ms later than the projector promises.",
                high - low < 4 ? fmt::format("{:.0f}", size) : fmt::format("{:.0f} to {:.0f}", low, high));
        case LightFault::projector_moved:
            return "The projector has moved, or its picture" + aside + ".";
        case LightFault::left_camera_moved:
            return "The left camera has moved" + aside + ".";
        case LightFault::right_camera_moved:
            return "The right camera has moved" + aside + ".";
        case LightFault::marker_slipped:
            return fmt::format("Marker {} has slipped by {:.1f} mm; the patient is followed without it.", marker + 1,
                               size);
        case LightFault::markers_moved:
            return fmt::format("The skin lies {:.1f} mm off where the markers put it: it rose or sank, or they moved.",
                               size);
        case LightFault::no_picture:
            return "No light of the plan is seen: the projector shows no picture, something is before its lens, or the "
                   "room's lamps outshine it.";
        case LightFault::other_picture:
            return "It became brighter beside the lines: a lamp, or another window or picture before the plan.";
        case LightFault::partly_covered:
            return fmt::format("Only {:.0f} % of the light is seen: something is before the projector or a camera.",
                               100 * size);
        case LightFault::light_off:
            return fmt::format("The light lies {:.1f} mm aside, and the cause is not known.", size);
    }
    return {};
}

std::string LightCause::remedy() const {
    switch (fault) {
        case LightFault::late_picture:
            return drawn_ahead ? "It is drawn ahead by that much; measure the delay anew with `planlight projector`."
                               : "Keep the head still, end what else uses the computer, and measure the delay anew "
                                 "with `planlight projector`.";
        case LightFault::projector_moved:
            return "Fix the projector and its picture, then press Scan: the scan finds where it stands now.";
        case LightFault::left_camera_moved:
        case LightFault::right_camera_moved:
            return "Fix the camera, then press Scan; if the scan is refused, calibrate the rig again.";
        case LightFault::marker_slipped:
            return "Paste it again, and scan anew when there is time.";
        case LightFault::markers_moved:
            return "Press \"Check skin\": it tells which. Then fix the markers, or scan the changed skin anew.";
        case LightFault::no_picture:
            return "Look whether the projector is on and its lens free, and turn the room's lamps down.";
        case LightFault::other_picture:
            return "Turn the lamp away, or close whatever lies on the projector's monitor.";
        case LightFault::partly_covered:
            return "Take it away, or look at the light where it is seen only.";
        case LightFault::light_off:
            return "Wait until the patient lies still; if it stays so, scan again.";
    }
    return {};
}

}  // namespace planlight
