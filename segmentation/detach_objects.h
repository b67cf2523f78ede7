#pragma once

#include <string>
#include <vector>

#include "segmentation/voxel_morphology.h"

namespace planlight {

/// The head, and what was cut off it.
struct DetachedBody {
    Mask body;               ///< with its enclosed cavities filled
    int pieces_removed = 0;  ///< of at least 0.05 ml
    double removed_ml = 0;
    std::vector<std::string> warnings;
};

/// What a hanging piece must touch to stay: the head and all pieces that stayed, or only the thick head itself. (A
/// strip along the head, broken in parts by higher thresholds, would hold on part by part.)
enum class Contact { with_body, with_core };

/// Keeps the head of all that is denser than air, and cuts off what merely touches it.
///
/// An opening by `detach_radius_mm` leaves the cores of thick things; the largest is the head. What is thinner hangs on
/// it: a piece that reaches no further than an ear from the core stays, skin position and all; one that reaches further
/// (plate, strap, wire) is tried again at higher thresholds, where the contact of an ear with a plate lets go, and
/// falls in the end. `values` are those of the volume, `threshold` the one that made `dense`. The body is empty when
/// nothing is thick enough.
DetachedBody detach_objects(const Mask& dense, const std::vector<float>& values, double threshold,
                            const VoxelGrid& grid, double detach_radius_mm, Contact contact = Contact::with_body);

}  // namespace planlight
