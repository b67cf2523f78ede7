#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "registration/matching/surface_sites.h"

namespace planlight {

/// Three scan sites that are kept in contact with the skin.
using Base = std::array<SurfaceSite, 3>;

/// Bases that determine a pose well: sides of about the scan's half width, of unequal length, normals that differ.
/// The best of many random triples each. Fewer than `count` when the sites do not hold that many.
std::vector<Base> choose_bases(const std::vector<SurfaceSite>& sites, int count, unsigned seed);

/// A pose that puts the three base points on (or near) three skin samples.
struct ContactPose {
    Eigen::Matrix3f R;  ///< ct from rig
    Eigen::Vector3f t;
};

/// Calls `found` for every triplet of skin samples that looks like the base: three side lengths to `tolerance_mm`, and how
/// each normal stands to the sides and to the triangle's own normal (which tells a triangle from its mirror image).
/// Pairs are matched along a ring round each first sample, then joined over the third side.
void for_each_contact_triplet(const Base& base, std::span<const SurfaceSite> skin, double tolerance_mm,
                              const std::function<void(const ContactPose&)>& found);

}  // namespace planlight
