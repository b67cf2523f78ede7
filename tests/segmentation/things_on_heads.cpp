// Electrodes, cushions, caps, bandages, hair: what lies on a head in a scanner, or about it on a CT's table.
#include <algorithm>
#include <cmath>

#include "tests/segmentation/strange_head_cases.h"

namespace planlight::test {

using Eigen::Vector3d;

namespace {

/// Whether a direction lies within 6 mm of one of some sixty places evenly over the upper head (a spiral).
bool near_electrode(const Vector3d& p) {
    constexpr int kPlaces = 120;
    const Vector3d way = p.normalized();
    if (way.z() < 0) return false;
    const double at = (1 - way.z()) / 2 * kPlaces;
    for (int n = static_cast<int>(at) - 12; n <= static_cast<int>(at) + 12; ++n) {
        const double z = 1 - 2 * (n + 0.5) / kPlaces, turn = 2.399963 * n;
        if (std::abs(z) >= 1) continue;
        const double flat = std::sqrt(1 - z * z);
        if (p.norm() * (way - Vector3d(flat * std::cos(turn), flat * std::sin(turn), z)).norm() < 6) return true;
    }
    return false;
}

bool in_rod(const Vector3d& p, const Vector3d& from, const Vector3d& to, double radius_mm) {
    const double along = std::clamp((p - from).dot(to - from) / (to - from).squaredNorm(), 0.0, 1.0);
    return (p - from - along * (to - from)).norm() < radius_mm;
}

}  // namespace

void add_things_that_lie_on_it(Cases& of) {
    const double r = of.radius_mm();
    of.with("electrodes with gel", Fate::not_bad,
            [](const Vector3d& p, double out) { return out < 6 && near_electrode(p); });
    of.with("cushion behind the head", Fate::said, [r](const Vector3d& p, double out) {
        return p.y() > 0.7 * r && out < 40 && std::abs(p.x()) < 60 && std::abs(p.z()) < 50;
    });
    of.with("cushion at one cheek", Fate::said, [r](const Vector3d& p, double out) {
        return p.x() > 0.5 * r && out < 30 && p.y() < -0.1 * r && p.z() < -0.3 * r;
    });
    of.with("cushions at both sides of the jaw", Fate::said,
            [r](const Vector3d& p, double out) { return std::abs(p.x()) > 0.6 * r && out < 30 && p.z() < -0.4 * r; });
    of.with("cushion behind the neck", Fate::said, [r](const Vector3d& p, double out) {
        return p.y() > 0 && out < 40 && std::abs(p.x()) < 70 && p.z() < -0.6 * r;
    });
    of.with("pads of 12 mm at both temples", Fate::said, [r](const Vector3d& p, double out) {
        return out < 12 && std::hypot(p.y(), p.z() - 0.1 * r) < 45 && std::abs(p.x()) > 0.5 * r;
    });
    of.with("cushion on the face", Fate::said,
            [r](const Vector3d& p, double out) { return p.y() < -0.5 * r && out < 40 && p.z() < 0.2 * r; });
    of.with("wet bandage round the forehead", Fate::said,
            [r](const Vector3d& p, double out) { return out < 9 && p.z() > 0.2 * r && p.z() < 0.7 * r; });
    of.with("blanket 10 mm off, from ear to ear below", Fate::not_bad,
            [r](const Vector3d& p, double out) { return out > 10 && out < 16 && p.y() > -0.5 * r && p.z() < 0.3 * r; });
    of.with("shell of a coil, 25 mm off", Fate::right,
            [](const Vector3d&, double out) { return out > 25 && out < 28; });
    of.all.back().only_mr = true;  // a CT's air does not get in under a closed one: refused
    of.with("head phones filled with gel", Fate::said, [](const Vector3d& p, double out) {
        return std::hypot(p.y(), p.z() + 30) < 40 && out < 28 && std::abs(p.x()) > 40;
    });
    of.with("hair soaked with gel, 8 mm", Fate::said,
            [r](const Vector3d& p, double out) { return out < 8 && p.z() > 0.1 * r + 0.6 * p.y() * -1; });
    of.with(
        "vitamin pills as markers", Fate::not_bad,
        [](const Vector3d& p, double out) {
            const Vector3d way = p.normalized();
            for (const auto& at :
                 {Vector3d(0.7, -0.5, 0.5), Vector3d(-0.7, -0.5, 0.5), Vector3d(0, -0.8, 0.6), Vector3d(0, 0.3, 0.95)})
                if (p.norm() * (way - at.normalized()).norm() < 5 && out < 7) return true;
            return false;
        },
        kFat_hu);
}

/// What lies on a head all round and equally thick.
void add_even_covers(Cases& of) {
    const double r = of.radius_mm();
    of.with("strap of 3 mm all round", Fate::said,
            [r](const Vector3d& p, double out) { return out < 3 && std::abs(p.z() - 0.5 * r) < 20; });
    of.with("wet bandage of 4 mm all over", Fate::said,
            [r](const Vector3d& p, double out) { return out < 4 && p.z() > 0.2 * r; });
    of.with("swimming cap of 2.6 mm", Fate::said,
            [r](const Vector3d& p, double out) { return out < 2.6 && p.z() > 0.1 * r - 0.2 * p.y(); });
    of.with("cap of 6 mm with gel", Fate::said,
            [r](const Vector3d& p, double out) { return out < 6 && p.z() > 0.1 * r - 0.2 * p.y(); });
    of.with("wet cover of jaw and neck, 10 mm", Fate::said,
            [r](const Vector3d& p, double out) { return out < 10 && p.z() < -0.55 * r; });
    of.with("rings of gel at both ears", Fate::said, [](const Vector3d& p, double out) {
        const double from_ear = std::hypot(p.y(), p.z() + 30);
        return from_ear > 22 && from_ear < 42 && out < 14 && std::abs(p.x()) > 40;
    });
    of.with(
        "bun as bright as scalp", Fate::said,
        [r](const Vector3d& p, double) { return (p - Vector3d(0, 1.25 * r, 0.6 * r)).norm() < 32; }, kFat_hu);
    of.made("void of a brace that takes nose and lip", Fate::said,
            [r](const Vector3d& p, double out, double, float& hu) {
                const bool gone = (p - Vector3d(0, -1.35 * r, -0.75 * r)).norm() < 38;
                if (gone) hu = kAir_hu;
                return out <= 0 && !gone;
            });
    of.all.back().only_mr = true;
}

/// What lies about a head on a CT's table.
void add_what_lies_on_a_table(Cases& of) {
    const double r = of.radius_mm();
    const auto in_ct = [&](const std::string& name, Fate fate, float hu,
                           std::function<bool(const Vector3d&, double out)> is_there) {
        of.with(name, fate, std::move(is_there), hu);
        of.all.back().only_ct = true;
    };
    in_ct("strap of 3 mm over the forehead", Fate::not_bad, -100,
          [r](const Vector3d& p, double out) { return out < 3 && p.y() < 0.3 * r && std::abs(p.z() - 0.5 * r) < 20; });
    in_ct("oxygen mask", Fate::said, 50, [r](const Vector3d& p, double) {
        const double d = (p - Vector3d(0, -1.2 * r, -0.8 * r)).norm();
        return d > 42 && d < 44;
    });
    in_ct("tube out of the mouth", Fate::not_bad, 100, [r](const Vector3d& p, double) {
        return in_rod(p, {0, -0.9 * r, -1.1 * r}, {30, -2.0 * r, -1.4 * r}, 5);
    });
    in_ct("cable over cheek and forehead", Fate::not_bad, 500, [r](const Vector3d& p, double out) {
        return out < 4 && p.y() < 0 && p.x() > 0 && std::abs(p.x() - 0.5 * r + 0.2 * p.z()) < 2.5;
    });
    in_ct("towel under the neck", Fate::said, -350, [r](const Vector3d& p, double out) {
        return p.y() > 0 && out < 35 && std::abs(p.x()) < 80 && p.z() < -0.6 * r;
    });
    in_ct("towel round the crown", Fate::said, -350,
          [r](const Vector3d& p, double out) { return out < 20 && p.z() > 0.6 * r; });
    in_ct("wedges of foam with a cover at both sides", Fate::not_bad, -120, [r](const Vector3d& p, double out) {
        return out < 2.5 && std::abs(p.x()) > 0.6 * r && p.y() > -0.6 * r && p.z() < 0.2 * r;
    });
    in_ct("pack of ice on one eye", Fate::said, 0,
          [r](const Vector3d& p, double) { return (p - Vector3d(38, -1.25 * r, -0.3 * r)).norm() < 32; });
    in_ct("pad of gel under the back of the head", Fate::said, 20, [r](const Vector3d& p, double out) {
        return p.y() > 0.5 * r && out < 18 && std::abs(p.x()) < 70 && std::abs(p.z()) < 60;
    });
    of.made("arms beside the head", Fate::not_bad, [r](const Vector3d& p, double out, double, float& hu) {
        const double axis = std::hypot(std::abs(p.x()) - 1.2 * r - 32, p.y());
        const bool arm = out > 0 && axis < 38;
        if (arm) hu = axis < 12 ? 800.0F : kWet_hu;
        return out <= 0 || arm;
    });
}

}  // namespace planlight::test
