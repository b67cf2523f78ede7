#pragma once

#include "planning_io/files/json_value.h"
#include "planning_io/types/rig_calibration.h"
#include "planning_io/types/rig_state.h"

// Rigs and what a scan found of them, as the JSON files hold them. Private to planning_io/case.
namespace planlight {

/// A device as it stands in rig.json (FORMATS.md); without `serial` where it is empty.
Json json_of(const CameraModel& device, const std::string& serial = {});
CameraModel camera_model_of(const JsonValue& value);
std::string serial_of(const JsonValue& value);  ///< of a device; empty when it has none

/// The rig's name as it stands in clouds, registrations and poses.
Json json_of(const RigName& name);
RigName rig_name_of(const JsonValue& value);

/// What the scan found of the rig, as it goes with cloud and registration.
Json json_of(const RigState& state);
RigState rig_state_of(const JsonValue& value);

}  // namespace planlight
