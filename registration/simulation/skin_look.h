#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace planlight::simulation {

/// A sticker pasted on the skin: a matte black disc on a white one. Distances are taken along the skin.
struct Sticker {
    Eigen::Vector3d centre_in_ct, normal_in_ct;
    bool covered = false;  ///< by blood: a dark blot of no particular shape

    static constexpr double kDiscRadius_mm = 4, kWhiteRadius_mm = 8, kBlotRadius_mm = 12;
};

enum class Material : std::uint8_t { none, skin, paper, ink, blood };

/// How a point of the head reflects.
struct Look {
    Material material = Material::skin;
    double albedo = 0;        ///< diffuse
    double specular = 0;      ///< strength of the highlight
    double translucent = 0;   ///< share of the light that leaves beside where it fell
};

/// Skin with patches and pores (seeded noise in ct) and what is stuck on it.
class SkinLook {
public:
    static constexpr double kSkinAlbedo = 0.62;

    explicit SkinLook(unsigned seed) : seed_(seed) {}
    Look at(const Eigen::Vector3d& p_in_ct) const;
    std::vector<Sticker> stickers;

private:
    Look skin(const Eigen::Vector3d& p_in_ct) const;
    std::uint64_t seed_;
};

}  // namespace planlight::simulation
