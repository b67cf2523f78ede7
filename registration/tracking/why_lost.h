#pragma once

#include <cstddef>

#include "registration/tracking/track_patient.h"

namespace planlight {

/// Why a frame may have no pose, as far as its pictures tell.
struct WhyLost {
    enum class Cause {
        exchanged,     ///< left and right are
        turned,        ///< both pictures stand on their heads
        mirrored,      ///< both pictures are
        camera_moved,  ///< each camera sees as many discs as there are markers, but few meet in space
        rearranged,    ///< as many meet in space, but not as they stood
        fewer_seen     ///< a camera sees fewer discs than there are markers
    } cause = Cause::fewer_seen;
    std::size_t left = 0, right = 0;  ///< discs that each camera sees in the frame as it is
};

/// For a frame in which `tracker` found no pose. The tracker stays as it is. Takes as long as several updates that
/// search both pictures whole.
WhyLost why_lost(const PatientTracker& tracker, const StereoFrame& frame);

}  // namespace planlight
