#include "tests/segmentation/mr_like.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "segmentation/distance_transform.h"
#include "segmentation/head_survey.h"
#include "segmentation/voxel_morphology.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

constexpr std::array<MrContrast, 4> kContrasts{
    {{"T1", 1.0F, 0.45F, 0.06F}, {"T2", 0.7F, 0.4F, 0.04F}, {"FLAIR", 0.8F, 0.45F, 0.05F}, {"PD", 0.8F, 0.7F, 0.08F}}};

/// Fat and all else apart, because the scanner shifts fat.
struct Signals {
    Volume fat, water;
};

/// A voxel of the rim between air and skin has the HU of fat, and is none: within the skin's thickness there is water.
Signals signals_of(const Volume& ct, const SkinMask& body, const MrContrast& contrast, double skin_mm) {
    Signals s{ct, ct};
    const VoxelGrid grid = grid_of(ct);
    const double rim_mm = grid.spacing_mm.minCoeff() / 2;  // from the surface to the first voxel's centre
    const std::vector<float> depth_mm = distance_from(body.body, 0, grid, 4);
    for (std::size_t v = 0; v < ct.values.size(); ++v) {
        const float hu = ct.values[v];
        s.fat.values[v] = s.water.values[v] = 0;
        if (!body.body[v]) {  // a voxel of the rim holds a share of tissue; cushion and holder show nothing
            bool rim = false;
            for_face_neighbours(grid, v, [&](std::size_t n) { rim = rim || body.body[n] != 0; });
            if (rim) s.water.values[v] = std::clamp((hu + 1000) / 1000, 0.0F, 0.5F) * contrast.soft;
            continue;
        }
        if (hu < -400) {
            const float share = std::clamp((hu + 1000) / 1000, 0.0F, 1.0F);
            s.water.values[v] = share * contrast.soft;
        } else if (hu < -30 && static_cast<double>(depth_mm[v]) - rim_mm < skin_mm) {
            s.water.values[v] = contrast.soft * std::clamp((hu + 1000) / 1000, 0.0F, 1.0F);
        } else if (hu < -30) {
            s.fat.values[v] = contrast.fat * std::clamp((hu + 1000) / 920, 0.0F, 1.0F);
        } else if (hu < 130) {
            s.water.values[v] = contrast.soft;
        } else {
            s.water.values[v] =
                contrast.soft + (contrast.bone - contrast.soft) * std::clamp((hu - 130) / 200, 0.0F, 1.0F);
        }
    }
    return s;
}

float sample(const Volume& volume, const Vector3d& voxel) {
    std::size_t low[3];
    float f[3];
    for (int a = 0; a < 3; ++a) {
        const double at = voxel[a];
        const int last = volume.size[static_cast<std::size_t>(a)] - 1;
        if (!(at >= 0) || !(at < last)) return 0;
        low[a] = static_cast<std::size_t>(at);
        f[a] = static_cast<float>(at - std::floor(at));
    }
    const std::size_t row = static_cast<std::size_t>(volume.size[0]),
                      slab = row * static_cast<std::size_t>(volume.size[1]);
    const float* at = volume.values.data() + low[2] * slab + low[1] * row + low[0];
    const auto x = [&](std::size_t o) { return at[o] + f[0] * (at[o + 1] - at[o]); };
    const float front = x(0) + f[1] * (x(row) - x(0)), back = x(slab) + f[1] * (x(slab + row) - x(slab));
    return front + f[2] * (back - front);
}

}  // namespace

MrDraw mr_like(const Volume& ct, const SkinMask& body, std::uint32_t seed, const MrLook& look) {
    std::mt19937 random(seed);
    const auto uniform = [&](double from, double to) {
        return std::uniform_real_distribution<double>(from, to)(random);
    };
    const MrContrast contrast = look.contrast.value_or(kContrasts[seed % kContrasts.size()]);
    const Signals signals = signals_of(ct, body, contrast, look.skin_mm);
    Vector3d spacing = Vector3d::Constant(uniform(look.least_mm, 2.0));
    double slice_mm = spacing.z();  // of what is measured of each step: the rest is a gap
    const bool thick = uniform(0, 1) < 0.25;
    if (thick) {
        spacing.z() = uniform(3, 5);
        slice_mm = spacing.z() * uniform(0.7, 1);
    }
    Eigen::Quaterniond turn(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
    turn.normalize();
    Eigen::AlignedBox3d head;
    for (std::size_t v = 0; v < body.body.size(); v += 3)
        if (body.body[v]) {
            const auto i = static_cast<int>(v % static_cast<std::size_t>(ct.size[0])),
                       j = static_cast<int>(v / static_cast<std::size_t>(ct.size[0]) %
                                            static_cast<std::size_t>(ct.size[1])),
                       k = static_cast<int>(v / static_cast<std::size_t>(ct.size[0]) /
                                            static_cast<std::size_t>(ct.size[1]));
            head.extend(turn.conjugate() * (ct.ct_from_voxel * Vector3d(i, j, k)));
        }
    const double margin_mm = uniform(12, 35);
    MrDraw draw;
    Volume& mr = draw.volume;
    mr.modality = "MR";
    mr.ct_from_voxel.linear() = turn.toRotationMatrix() * Eigen::Matrix3d(spacing.asDiagonal());
    mr.ct_from_voxel.translation() = turn * (head.min() - Vector3d::Constant(margin_mm));
    for (int a = 0; a < 3; ++a)
        mr.size[static_cast<std::size_t>(a)] =
            std::max(16, static_cast<int>((head.sizes()[a] + 2 * margin_mm) / spacing[a]));
    const double drawn_noise = uniform(0.01, 0.15),
                 noise = look.noise.value_or(drawn_noise) * static_cast<double>(contrast.soft),
                 drawn_ratio = uniform(1, 3), ratio = look.coil > 0 ? look.coil : drawn_ratio,
                 drawn_shift_mm = uniform(0, 1.5), fat_shift_mm = look.fat_shift_mm.value_or(drawn_shift_mm),
                 ghost = uniform(0, 0.06), wrap = uniform(0, 0.06);
    const Vector3d coil = Vector3d(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)).normalized(),
                   middle = turn * head.center();
    const Vector3d readout = turn * Vector3d::UnitX();
    const Eigen::Affine3d ct_voxel = ct.ct_from_voxel.inverse();
    mr.values.assign(mr.index(0, 0, mr.size[2]), 0);
    tbb::parallel_for(0, mr.size[2], [&](int k) {
        for (int j = 0; j < mr.size[1]; ++j)
            for (int i = 0; i < mr.size[0]; ++i) {
                float sum = 0;
                for (int corner = 0; corner < 8; ++corner) {
                    const Vector3d aside((corner & 1) ? 0.25 : -0.25, (corner & 2) ? 0.25 : -0.25,
                                         ((corner & 4) ? 0.25 : -0.25) * slice_mm / spacing.z());
                    const Vector3d p = mr.ct_from_voxel * (Vector3d(i, j, k) + aside);
                    sum += sample(signals.water, ct_voxel * p) +
                           sample(signals.fat, ct_voxel * (p + fat_shift_mm * readout));
                }
                const Vector3d p = mr.ct_from_voxel * Vector3d(i, j, k);
                mr.values[mr.index(i, j, k)] =
                    sum / 8 * static_cast<float>(std::pow(ratio, (p - middle).dot(coil) / 200));
            }
    });
    const std::vector<float> clean = mr.values;
    const int shift = mr.size[1] / 3;
    std::normal_distribution<double> normal(0, noise);
    for (int k = 0; k < mr.size[2]; ++k)
        for (int j = 0; j < mr.size[1]; ++j)
            for (int i = 0; i < mr.size[0]; ++i) {
                const auto other = [&](int to) {
                    return static_cast<double>(clean[mr.index(i, (to % mr.size[1] + mr.size[1]) % mr.size[1], k)]);
                };
                double value = static_cast<double>(clean[mr.index(i, j, k)]) +
                               ghost * 0.5 * (other(j + shift) + other(j - shift)) + wrap * other(j + mr.size[1] / 2);
                value = std::hypot(value + normal(random), normal(random));
                mr.values[mr.index(i, j, k)] = static_cast<float>(1000 * value);
            }
    draw.said = fmt::format(
        "{} {:.2f} x {:.2f} mm, noise {:.0f} %, coil {:.1f}:1, fat {:.1f} mm, ghost {:.0f} %, wrap {:.0f} %",
        contrast.name, spacing.x(), spacing.z(), 100 * noise / static_cast<double>(contrast.soft), ratio, fat_shift_mm,
        100 * ghost, 100 * wrap);
    return draw;
}

}  // namespace planlight::test
