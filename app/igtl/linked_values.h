#pragma once

#include <optional>
#include <string>

#include "app/igtl/message_server.h"
#include "planning_io/types/rigid_transform.h"
#include "projection/light_gate.h"

namespace planlight {

/// What a session says to other systems, at one moment.
struct LinkedValues {
    std::optional<RigidTransform> patient_from_ct;   ///< T_ini; empty: there is no match that may be used
    std::optional<RigidTransform> rig_from_patient;  ///< T_cur; empty: the pose is not known
    double matched_utc_s = 0, seen_utc_s = 0;        ///< when the match was made; the middle of the exposure
    LightTrust trust = LightTrust::dark;             ///< what the gate says
    std::string words = "No light was asked for yet.";
    double said_utc_s = 0;
    std::optional<double> off_mm, sigma_mm;  ///< of the light, as the gate last measured it; one standard deviation
    double predicted_error_mm = 0, bound_95_mm = 0;  ///< of the pose (`TrackedPose`)
};

/// Which message stands for what: T_ini, T_cur and T_global as TRANSFORM, all three as TDATA "Poses", the gate as
/// STATUS "Gate", and as SENSOR in mm "LightError" (off, sigma) and "PoseError" (one sigma, bound of 95 %). What is not
/// known is not said. Only what is another than in `before` is made anew; null: everything.
void set_messages(MessageServer& server, const LinkedValues& now, const LinkedValues* before);

/// STATUS "Gate" alone, as of now: so that who listens sees that the line is alive.
void set_gate_message(MessageServer& server, const LinkedValues& now, double utc_s);
/// The session has not been heard for a while: STATUS "Gate" says "stale", and no pose is said.
void set_stale_messages(MessageServer& server, double utc_s);

}  // namespace planlight
