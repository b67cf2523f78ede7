#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>

#include "planning_io/types/volume.h"
#include "registration/simulation/surface.h"

namespace planlight::simulation {

/// The true skin: the zero level of the CT field. Rays find it by a fine mesh first and are then refined on the field.
class TrueSurface final : public Surface {
public:
    /// Throws std::invalid_argument when no head surface is in the volume.
    TrueSurface(const Volume& volume, double threshold);
    ~TrueSurface() override;

    std::optional<Hit> first_hit(const Eigen::Vector3d& origin_in_ct, const Eigen::Vector3d& direction) const override;
    bool in_shadow(const Eigen::Vector3d& p_in_ct, const Eigen::Vector3d& normal_in_ct,
                   const Eigen::Vector3d& light_in_ct) const override;

    struct Nearest {
        Eigen::Vector3d p_in_ct;
        Eigen::Vector3d normal_in_ct;  ///< outwards, smooth
        double signed_mm = 0;          ///< positive outside
    };
    /// The skin point nearest to `p_in_ct`, on the field itself.
    Nearest nearest(const Eigen::Vector3d& p_in_ct) const;

    Eigen::Vector3d low_in_ct() const override;
    Eigen::Vector3d high_in_ct() const override;
    std::size_t triangle_count() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight::simulation
