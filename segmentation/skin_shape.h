#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "planning_io/types/triangle_mesh.h"
#include "planning_io/types/volume.h"
#include "segmentation/middle_plane.h"
#include "segmentation/segment_skin.h"

namespace planlight {

/// Where the volume ends within the head: no skin to scan, to match or to draw on (`kCutPlane`).
struct CutSide {
    std::string name;  ///< "crown", "neck", "chin", "face", "back", "left side", "right side"
    double area_cm2 = 0;
    bool usual = false;       ///< a neck's: every head scan ends there
    double boneless_cm2 = 0;  ///< of it: what lies on the head ends there (`boneless_ends`)
};

/// The largest ball within the upper head: the skull's size and middle.
struct HeadBall {
    double radius_mm = 0;  ///< an adult's 65 to 80, a newborn's 45
    Eigen::Vector3d centre_in_ct = Eigen::Vector3d::Zero();
};

/// Sought in the upper 150 mm, so that it is the skull's and not the chest's. What the volume does not show is taken
/// for body: it does not make a ball small; but the ball's middle is one of the body that it shows. `skin` has
/// vertices.
HeadBall largest_ball(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin);

/// How far a thin thing that hangs on the head (a strap, a wire) leads away from it, mm along itself; an ear's rim 50
/// at most. Steps along the axes, so that a way aslant is longer than it is. `skin` has vertices.
double strand_length_mm(const Volume& volume, const SkinMask& mask, const TriangleMesh& skin);

/// Where most of some places of the skin lie: "the forehead, the left side"; of those that hold a fifth of them.
std::string where_on_head(const std::vector<Eigen::Vector3d>& places_in_ct, const HeadBall& ball);

/// The ends of the volume within the head, by their anatomical names, of more than 1 square cm each. `boneless`: of
/// each vertex, or empty.
std::vector<CutSide> cut_sides_of(const TriangleMesh& skin, const HeadBall& ball,
                                  const std::vector<std::uint8_t>& boneless);

/// How far a nose stands out before the cheeks, mm, at the height where it does most; not a number where the volume
/// ends above it or no front is in it. Of a head whose middle plane shows that it
/// looks aside it is sought along that plane, too.
double nose_length_mm(const TriangleMesh& skin, const HeadBall& ball, const MiddlePlane& plane);

}  // namespace planlight
