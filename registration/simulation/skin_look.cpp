#include "registration/simulation/skin_look.h"

#include <algorithm>
#include <cmath>

#include "registration/simulation/hash.h"

namespace planlight::simulation {

using Eigen::Vector3d;

namespace {

/// Smooth noise in [-1, 1] with features of about one unit.
double value_noise(const Vector3d& p, std::uint64_t seed) {
    const Vector3d cell = p.array().floor();
    const Vector3d f = p - cell;
    const Vector3d s = f.array().square() * (3 - 2 * f.array());
    const auto i = cell.cast<std::int64_t>();
    double sum = 0;
    for (int c = 0; c < 8; ++c) {
        const auto x = static_cast<std::uint64_t>(i.x() + (c & 1)),
                   y = static_cast<std::uint64_t>(i.y() + ((c >> 1) & 1)),
                   z = static_cast<std::uint64_t>(i.z() + (c >> 2));
        const std::uint64_t h = mixed(seed + x * 0x8da6b343U + y * 0xd8163841U + z * 0xcb1ab31fU);
        const double weight =
            ((c & 1) ? s.x() : 1 - s.x()) * ((c & 2) ? s.y() : 1 - s.y()) * ((c & 4) ? s.z() : 1 - s.z());
        sum += weight * static_cast<double>(h >> 40) * 0x1p-24;
    }
    return 2 * sum - 1;
}

/// The rim of a blot in a direction round the sticker.
double blot_radius_mm(const Sticker& sticker, const Vector3d& way) {
    const Vector3d along = way.cross(sticker.normal_in_ct).normalized();
    return Sticker::kBlotRadius_mm + 2.5 * value_noise(2.2 * along + sticker.centre_in_ct, 77);
}

}  // namespace

Look SkinLook::skin(const Vector3d& p) const {
    const double patches = value_noise(p / 11, seed_), mottle = value_noise(p / 3.1, seed_ + 1);
    const double pores = value_noise(p / 0.9, seed_ + 2);
    const double shade = 1 + 0.06 * patches + 0.03 * mottle + 0.035 * std::min(0.0, pores + 0.2);
    const double film = wet > 0 ? wet * std::clamp(0.6 + value_noise(p / 17, seed_ + 4), 0.0, 1.0) : 0;
    return {Material::skin, kSkinAlbedo * shade * (1 - 0.15 * film), 0.03 + 0.008 * patches + 0.25 * film, 0.3};
}

Look SkinLook::at(const Vector3d& p) const {
    constexpr double kReach_mm = Sticker::kBlotRadius_mm + 3;
    for (const Sticker& sticker : stickers) {
        const Vector3d way = p - sticker.centre_in_ct;
        const double square = way.squaredNorm();
        if (square > kReach_mm * kReach_mm) continue;
        const double distance =
            std::sqrt(square);  // the chord; the way along the skin is longer by less than 1e-3 of it
        if (sticker.covered) {
            if (distance < 1e-9 || distance < blot_radius_mm(sticker, way))
                return {Material::blood, 0.12 * (1 + 0.3 * value_noise(p / 2, seed_ + 3)), 0.06, 0};
            continue;
        }
        if (distance < Sticker::kDiscRadius_mm) return {Material::ink, 0.035, 0.004, 0};
        if (distance < Sticker::kWhiteRadius_mm) return {Material::paper, 0.74, 0.004, 0};
    }
    return skin(p);
}

}  // namespace planlight::simulation
