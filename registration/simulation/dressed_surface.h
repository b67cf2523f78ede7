#pragma once

#include <memory>

#include "registration/simulation/room_things.h"
#include "registration/simulation/true_surface.h"

namespace planlight::simulation {

/// The head and what lies round and over it, as rays meet them. Without things it is the head alone.
class DressedSurface final : public Surface {
public:
    explicit DressedSurface(const TrueSurface& head);
    ~DressedSurface() override;

    /// Takes the place of what was there.
    void lay(ThingsMesh things);

    std::optional<Hit> first_hit(const Eigen::Vector3d& origin_in_ct, const Eigen::Vector3d& direction) const override;
    bool in_shadow(const Eigen::Vector3d& p_in_ct, const Eigen::Vector3d& normal_in_ct,
                   const Eigen::Vector3d& light_in_ct) const override;
    Eigen::Vector3d low_in_ct() const override;
    Eigen::Vector3d high_in_ct() const override;

private:
    struct Things;
    const TrueSurface& head_;
    std::unique_ptr<Things> things_;
};

}  // namespace planlight::simulation
