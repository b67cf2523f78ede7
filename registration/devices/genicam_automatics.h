#pragma once

#include <arv.h>

#include <string>
#include <vector>

namespace planlight {

/// Has a camera send what its sensor measured, and all of it at once: what it does by itself (exposure, gain, black
/// level, white balance, gamma, sharpening, denoising, tables, test pictures) is switched off, a global shutter is
/// chosen where there is one (names: GenICam SFNC 2.7), and each is read back. Says what stays as it should not, a
/// phrase each ("its gamma stays at 0.45"): an own brightness changes pictures between two of a scan, a rolling shutter
/// bends a head that moves, a mirrored picture fits no rig. Features that a camera has not are left out.
std::vector<std::string> switch_off_automatics(ArvCamera* camera);

/// Which shutter the camera says it has.
enum class Shutter { unknown, global, other };
Shutter shutter_of(ArvCamera* camera);

}  // namespace planlight
