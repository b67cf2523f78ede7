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
/// The first are the best of many random triples each. The widest triples lie at the scan's rim, where cloth is: the
/// others are the best of few, every second one in a half of the scan, which may be bare. Fewer than `count` when the
/// sites do not hold that many.
std::vector<Base> choose_bases(const std::vector<SurfaceSite>& sites, int count, unsigned seed);

/// A pose that puts the three base points on (or near) three skin samples.
struct ContactPose {
    Eigen::Matrix3f R;  ///< ct from rig
    Eigen::Vector3f t;
};

/// The skin samples with how each pair of them stands to each other, worked out once for all bases. Of more than
/// `most_kept` samples (a whole body; a head has about 700) each pair is worked out when it is asked for instead: 16
/// bytes a pair would fill the memory.
class SkinPairs {
public:
    explicit SkinPairs(std::vector<SurfaceSite> skin, std::size_t most_kept = 3000);

    const std::vector<SurfaceSite>& skin() const { return skin_; }

    /// How a pair looks: its side, the cosines of both normals with it, and of the normals with each other.
    struct Shape {
        float length_mm, first, second, between;
    };
    static Shape shape_of(const SurfaceSite& a, const SurfaceSite& b);

    /// The samples that stand to sample `a` as `wanted` says, to a tolerance; all of them, or of those in `among`.
    void find_alike(const Shape& wanted, std::size_t a, float tolerance_mm, std::vector<int>& found) const;
    void find_alike(const Shape& wanted, std::size_t a, float tolerance_mm, std::span<const int> among,
                    std::vector<int>& found) const;

private:
    Shape shape(std::size_t a, std::size_t b) const;

    std::vector<SurfaceSite> skin_;
    bool kept_;
    std::vector<float> length_, first_, second_, between_;  ///< row a: of the pairs (a, b)
};

/// Calls `found` for every triplet of skin samples that looks like the base: three side lengths to `tolerance_mm`, and
/// how each normal stands to the sides and to the triangle's own normal (which tells a triangle from its mirror image).
/// Pairs are matched along a ring round each first sample, then joined over the third side.
void for_each_contact_triplet(const Base& base, const SkinPairs& pairs, double tolerance_mm,
                              const std::function<void(const ContactPose&)>& found);

}  // namespace planlight
