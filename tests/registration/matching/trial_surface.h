#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "planning_io/types/triangle_mesh.h"

namespace planlight::test {

/// A surface that rays are cast on (Embree): the truth of the trials. Shares nothing with table or matcher.
class TrialSurface {
public:
    /// In ct; turned outwards. Throws std::invalid_argument when it has no triangles.
    explicit TrialSurface(TriangleMesh mesh);
    ~TrialSurface();
    TrialSurface(TrialSurface&& other) noexcept;

    struct Hit {
        Eigen::Vector3d p_in_ct, normal_in_ct;  ///< the triangle's normal
        std::uint8_t flag = kSkin;              ///< of the nearest corner
    };
    /// The first triangle along the ray (`direction` of unit length).
    std::optional<Hit> first_hit(const Eigen::Vector3d& origin_in_ct, const Eigen::Vector3d& direction) const;

    Eigen::Vector3d low_in_ct() const;
    Eigen::Vector3d high_in_ct() const;
    Eigen::Vector3d middle_in_ct() const { return 0.5 * (low_in_ct() + high_in_ct()); }
    const TriangleMesh& mesh() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight::test
