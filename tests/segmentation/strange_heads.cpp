#include "tests/segmentation/strange_heads.h"

#include <cmath>
#include <memory>

#include "tests/segmentation/spoil_volume.h"
#include "tests/segmentation/strange_head_cases.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

constexpr float kBone_hu = 300;

void add_what_is_missing(Cases& of) {
    const double r = of.radius_mm();
    of.made("flap of bone is out", Fate::not_bad, [r](const Vector3d& p, double out, double, float& hu) {
        if (hu > 130 && (p - Vector3d(r, 0, 0.4 * r)).norm() < 45) hu = kWet_hu;
        return out <= 0;
    });
    of.made("mouth full of metal", Fate::not_bad, [r](const Vector3d& p, double out, double, float& hu) {
        if ((p - Vector3d(0, -1.1 * r, -1.2 * r)).norm() < 45) hu = kAir_hu;
        return out <= 0 && hu > -900;
    });
    of.made("valve that wipes out the scalp beside it", Fate::not_bad,
            [r](const Vector3d& p, double out, double, float& hu) {
                const bool wiped = (p - Vector3d(0.75 * r, 0.6 * r, 0.4 * r)).norm() < 32;
                if (wiped) hu = kAir_hu;
                return out <= 0 && !wiped;
            });
    of.made("fontanelle and thin bone", Fate::not_bad, [r](const Vector3d& p, double out, double depth, float& hu) {
        if (hu > 130 && (depth > 8 || (p - Vector3d(0, -0.3 * r, 1.0 * r)).norm() < 35)) hu = kWet_hu;
        return out <= 0;
    });
    of.made("face taken away", Fate::said, [r](const Vector3d& p, double out, double, float& hu) {
        const bool face = p.y() < -0.55 * r - 0.5 * (p.z() + 0.2 * r) && p.z() < 0;
        if (face) hu = kAir_hu;
        return out <= 0 && !face;
    });
    of.last_turned("face taken away, chin on the chest by 30 degrees", -30, {1, 0, 0});
    of.last_turned("face taken away, chin on the chest, then aside by 40 degrees", 40, {0, 0, 1});
    of.made("brain alone", Fate::refused, [r](const Vector3d& p, double, double depth, float& hu) {
        const bool brain = depth > 14 && hu > 0 && hu < 130 && p.z() > -0.5 * r && p.norm() < 1.15 * r;
        if (!brain) hu = kAir_hu;
        return brain;
    });
    of.made("skull alone, wet", Fate::refused, [](const Vector3d&, double, double, float& hu) {
        const bool bone = hu > kBone_hu;
        hu = bone ? kWet_hu : kAir_hu;
        return bone;
    });
}

void add_no_heads(Cases& of) {
    of.solid("ball of 80 mm", [](const Vector3d& p) { return p.norm() < 80; });
    of.solid("bottle", [](const Vector3d& p) { return std::hypot(p.x(), p.y()) < 70 && std::abs(p.z()) < 85; });
    of.solid("box", [](const Vector3d& p) { return p.cwiseAbs().maxCoeff() < 65; });
    // Rind, pith, flesh: layers, but no face.
    of.made("melon", Fate::said, [](const Vector3d& p, double, double, float& hu) {
        const double d = 80 - p.norm();
        hu = d < 0 ? kAir_hu : d > 5 && d < 12 ? 900.0F : kWet_hu;
        return d > 0;
    });
}

void add_heads_askew(Cases& of) {
    of.turned("chin on the chest, 30 degrees", -30, {1, 0, 0});
    of.turned("chin up, 30 degrees", 30, {1, 0, 0});
    of.turned("leaning to the side, 30 degrees", 30, {0, 1, 0});
    of.turned("looking aside, 40 degrees", 40, {0, 0, 1});
    of.turned("on its side", 90, {0, 0, 1});
    of.turned("on its face", 180, {0, 0, 1});
}

void add_rare_contrasts(Cases& of) {
    of.in_contrast("fat is dark", Fate::not_bad, {"fat-suppressed", 0.08F, 0.5F, 0.04F});
    of.in_contrast("bone shines half", Fate::not_bad, {"UTE", 0.8F, 0.7F, 0.4F});
    of.in_contrast("fat alone is bright", Fate::not_bad, {"fat image", 1.0F, 0.05F, 0.25F});
    of.in_contrast("blood alone is bright", Fate::not_bad, {"ToF", 0.35F, 0.22F, 0.03F});
}

/// Coils of 7 T, greys that were cut, and a patient who moved within the series.
void add_spoilt_volumes(Cases& of) {
    for (const MrContrast& contrast : {MrContrast{"T1", 1.0F, 0.45F, 0.06F}, MrContrast{"T2", 0.7F, 0.4F, 0.04F}}) {
        of.in_contrast(std::string("coil shading of 10 : 1, ") + contrast.name, Fate::not_bad, contrast);
        of.all.back().coil = 10;
    }
    of.spoilt("8 bits, nothing cut", Fate::quiet, [](Volume& mr) { window_to_8_bits(mr, 0); });
    for (const int percent : {8, 16, 24})
        of.spoilt("8 bits, dark end cut at " + std::to_string(percent) + " %", Fate::not_bad,
                  [percent](Volume& mr) { window_to_8_bits(mr, percent / 100.0); });
    of.spoilt("ratio of two images, noise in the air", Fate::not_bad, divide_by_another);
    of.spoilt("moved by 9 mm", Fate::said, [](Volume& mr) { blend_with_moved(mr, {3, 7, -4.7}, 0); });
    of.spoilt("moved by 6 mm", Fate::said, [](Volume& mr) { blend_with_moved(mr, {0, 6, 0}, 0); });
    of.spoilt("moved by 4 mm and 5 degrees", Fate::said, [](Volume& mr) { blend_with_moved(mr, {0, 2, 3.5}, 5); });
    of.spoilt("moved by 9 mm for a third of the lines", Fate::said, [](Volume& mr) {
        blend_with_moved(mr, {0, 2, 8.8}, 0, 0.33);
    });
}

void add_what_a_ct_shows(Cases& of) {
    const double r = of.radius_mm();
    of.in_ct("metal teeth with streaks", Fate::not_bad, [r](const Vector3d& p, double out, double, float& hu) {
        const Vector3d q = p - Vector3d(0, -0.9 * r, -0.95 * r);
        if (std::abs(q.z()) > 6) return out <= 0;
        const double turn = std::atan2(q.y(), q.x()), far = q.head<2>().norm();
        hu += static_cast<float>(900 * std::cos(24 * turn) * std::exp(-far / 60));
        if (far < 8) hu = 3000;
        return out <= 0;
    });
    of.in_ct("posts and pins of a frame", Fate::not_bad, [](const Vector3d& p, double out, double depth, float& hu) {
        const double aside = std::abs(p.x()), back = std::abs(p.y());
        if (std::hypot(aside - 105, back - 95) < 8) hu = 2500;
        const double along = (aside * 105 + back * 95) / 141.6, across = std::abs(aside * 95 - back * 105) / 141.6;
        if (std::hypot(across, p.z() - 20) < 3.5 && along > 20 && along < 145 && depth < 8) hu = 2500;
        return out <= 0;
    });
    of.in_ct("bun of wet hair", Fate::said, [r](const Vector3d& p, double out, double, float& hu) {
        if (out > 0 && (p - Vector3d(0, 1.25 * r, 0.5 * r)).norm() < 35) hu = -300;
        return out <= 0;
    });
    of.in_ct("gauze round the forehead", Fate::said, [r](const Vector3d& p, double out, double, float& hu) {
        if (out > 0 && out < 8 && p.z() > 0.2 * r && p.z() < 0.7 * r) hu = -350;
        return out <= 0;
    });
    of.in_ct("round field of view", Fate::not_bad, [r](const Vector3d& p, double out, double, float& hu) {
        if (std::hypot(p.x(), p.y() + 0.4 * r) > r) hu = kAir_hu;
        return out <= 0;
    });
    of.all.back().sharp = true;
    of.in_ct("darker is denser", Fate::refused, [](const Vector3d&, double out, double, float& hu) {
        hu = -hu - 900;
        return out <= 0;
    });
}

}  // namespace

std::vector<StrangeCase> strange_heads_of(const Volume& ct, const SkinMask& body, const TriangleMesh& skin) {
    Cases of(std::make_shared<const HeadMaker>(ct, body, skin));
    of.scaled("as it is", Fate::right, 1);
    of.scaled("a child of six, 0.88", Fate::right, 0.88);
    of.scaled("a baby of one, 0.75", Fate::right, 0.75);
    of.scaled("newborn, 0.62", Fate::right, 0.62);
    of.scaled("coil on one side, 5 : 1", Fate::not_bad, 1, 5);
    of.scaled("coil on one side, 8 : 1", Fate::not_bad, 1, 8);
    add_things_that_lie_on_it(of);
    add_what_is_missing(of);
    add_no_heads(of);
    add_heads_askew(of);
    add_rare_contrasts(of);
    add_spoilt_volumes(of);
    add_even_covers(of);
    add_what_a_ct_shows(of);
    add_what_lies_on_a_table(of);
    return std::move(of.all);
}

}  // namespace planlight::test
