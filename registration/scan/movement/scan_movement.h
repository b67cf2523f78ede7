#pragma once

#include <optional>
#include <string>

#include "registration/scan/scan_surface.h"

namespace planlight {

/// How far the patient moved between the pictures of one scan.
struct ScanMovement {
    enum class By { nothing, markers, pictures } by = By::nothing;  ///< nothing: not known, and the next two are 0
    double moved_mm = 0;  ///< greatest way between two moments: of a marker, or of most of the lit skin across the line
                          ///< of sight (by pictures: without what scatter makes)
    double sigma_mm = 0;  ///< of `moved_mm` between two moments, one standard deviation; by pictures only
    double turned = 0;    ///< radians, between those moments; by markers only
    std::string from, to;  ///< names of the pictures at those moments
    int moments = 0;       ///< looked at
    int markers = 0;
    bool throughout = false;  ///< by markers: seen in half of the moments, from the first third to the last
    double light_change = 0;  ///< largest between two moments of one kind (fringes; others) or two pictures of one, as
                              ///< a share; by pictures only
    double camera_gamma = 1;  ///< what was taken out of the pictures; by pictures only

    /// The way that is compared with a limit, mm: pictures show about half of it (one to three quarters), markers all.
    double way_mm() const { return by == By::pictures ? 2 * moved_mm : moved_mm; }
    /// A way that would not be seen for the scatter of the measurement (two sigma), mm.
    double unseen_mm() const { return by == By::pictures ? 4 * sigma_mm : 0; }
};

/// From the skin itself, without markers: every even picture of a camera (`uniform_light_frames`), and of a code
/// without inverses what is lit in each bit, is laid on the first by an affine map (`affine_movement`).
/// `..._mm_per_px`: of the skin in that camera's picture; 0: that camera is not asked. Each camera sees what moves
/// across its own line of sight: of a head's way a third to three quarters; what moves along one's is seen by the other
/// (along the line between the two by each, and by the sine of half their angle alone). The camera that sees more
/// counts. What is saturated in any frame, and its surroundings, has no say. `sigma_mm` is what the measurement itself
/// scatters in the camera where that is more, and `moved_mm` is without two sigmas. `by` is `nothing` with under two
/// moments or too little that could move in the pictures.
ScanMovement movement_in_pictures(const ScanCapture& capture, double left_mm_per_px, double right_mm_per_px = 0);

/// What a pixel of that camera is on the scanned points, mm (median); 0 without points or camera.
double mm_per_pixel(const PointCloud& cloud, const CameraModel& camera);

}  // namespace planlight
