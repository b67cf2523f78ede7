#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "planning_io/types/volume.h"
#include "segmentation/segment_skin.h"

namespace planlight::test {

/// What a draw is: an MR that a scanner could have made of the patient of a CT.
struct MrDraw {
    Volume volume;
    std::string said;  ///< contrast, voxel, noise, bias ...
};

/// Signal of fat, of all other soft tissue, and of bone.
struct MrContrast {
    const char* name = "";
    float fat = 1, soft = 1, bone = 0;
};

/// What is not drawn.
struct MrLook {
    double least_mm = 0.8;                    ///< of a voxel
    double coil = 0;                          ///< brightest to darkest place; 0: drawn up to 3
    std::optional<MrContrast> contrast;       ///< else T1, T2, FLAIR or PD by the seed
    std::optional<double> fat_shift_mm = {};  ///< else up to 1.5
    std::optional<double> noise = {};         ///< of the soft tissue; else 0.01 to 0.15
    /// Epidermis and dermis, which are water, over the fat: 1.5 to 2.5 mm on scalp and face; less on the lids, under
    /// which no fat lies. 0: what a CT's voxels mix of skin and air passes for fat.
    double skin_mm = 1.5;
};

/// Dark bone, bright fat (T1), bright water (T2), dark water (FLAIR) or all alike (PD), 0.8 to 2 mm (thick slices with
/// gaps of up to 5 mm), turned anyhow, coil shading to 3:1, Rician noise to 15 % of the soft tissue, fat shifted along
/// the readout by up to 1.5 mm, ghosts and wrap of up to 6 %. `ct` in HU with the mask of its body (what the table
/// shows is left out).
MrDraw mr_like(const Volume& ct, const SkinMask& body, std::uint32_t seed, const MrLook& look = {});

}  // namespace planlight::test
