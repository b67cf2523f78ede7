#pragma once

#include <string>

#include "planning_io/types/triangle_mesh.h"
#include "planning_io/types/volume.h"

namespace planlight::test {

/// What became of a volume, against its true skin.
struct SkinScore {
    bool refused = false;
    bool doubted = false;  ///< taken with a warning; that the volume ends within the head is none
    double off_percent =
        0;  ///< of the true skin further than 2 mm from ours; not a number when refused, or nothing was compared
    double p95_mm = 0;                        ///< of its distance
    double rms_mm = 0;                        ///< of it, where it is nearer than 2 mm
    double sigma_mm = 0, noise_sigma_mm = 0;  ///< as `SkinJudgement` says them
    double echo = 0;                          ///< the same; of an MR
    std::string why;                          ///< the doubts' or the refusal's beginnings
    TriangleMesh skin;                        ///< ours, also of what was refused for its looks

    /// Also where nothing could be compared.
    bool taken_wrongly() const { return !refused && !doubted && !(off_percent <= 1); }
};

/// Segments, judges and measures as `planlight prepare` does. What lies behind a lid or an end of the volume is flagged
/// as no skin by our surface, and is not counted.
SkinScore score_of(const Volume& volume, const TriangleMesh& truth);

}  // namespace planlight::test
