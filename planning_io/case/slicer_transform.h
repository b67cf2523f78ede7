#pragma once

#include <filesystem>

#include "planning_io/types/rigid_transform.h"

namespace planlight {

/// A transform for 3D Slicer (ITK's text format, `.tfm`): with it, what is loaded in rig coordinates lies where it was
/// matched in the CT. ITK's files hold the way back, from the place after the transform to the place before it, in LPS;
/// so this is `patient_from_ct` itself. Scan and transform are loaded, the scan is put under the transform.
void write_slicer_transform(const RigidTransform& patient_from_ct, const std::filesystem::path& file);

}  // namespace planlight
