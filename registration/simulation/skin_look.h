#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "registration/simulation/surface.h"

namespace planlight::simulation {

/// A sticker pasted on the skin: a matte black disc on a white one. Distances are taken along the skin.
struct Sticker {
    Eigen::Vector3d centre_in_ct, normal_in_ct;
    bool covered = false;  ///< by blood: a dark blot of no particular shape

    static constexpr double kDiscRadius_mm = 4, kWhiteRadius_mm = 8, kBlotRadius_mm = 12;
};

/// Skin with patches and pores (seeded noise in ct) and what is stuck on it.
class SkinLook final : public SurfaceLook {
public:
    static constexpr double kSkinAlbedo = 0.62;

    explicit SkinLook(unsigned seed) : seed_(seed) {}
    Look at(const Eigen::Vector3d& p_in_ct) const override;
    std::vector<Sticker> stickers;
    double wet = 0;  ///< 0 dry to 1: the highlights of a film of water, in patches

private:
    Look skin(const Eigen::Vector3d& p_in_ct) const;
    std::uint64_t seed_;
};

}  // namespace planlight::simulation
