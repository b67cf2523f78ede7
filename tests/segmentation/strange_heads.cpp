#include "tests/segmentation/strange_heads.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

#include "segmentation/head_survey.h"
#include "segmentation/skin_shape.h"
#include "tests/segmentation/spoil_volume.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

constexpr float kWet_hu = 40, kFat_hu = -90, kAir_hu = -1000;
constexpr float kBone_hu = 300;

/// The head that is made strange, with the distance of each voxel from its skin, mm: outwards, and under it.
class Maker {
public:
    Maker(const Volume& ct, const SkinMask& body, const TriangleMesh& skin)
        : ct_(ct), body_(body), skin_(skin), ball_(largest_ball(ct, body, skin)) {
        const VoxelGrid grid = grid_of(ct);
        out_mm_ = distance_from(body.body, 1, grid, 60);
        depth_mm_ = distance_from(body.body, 0, grid, 60);
    }
    double radius_mm() const { return ball_.radius_mm; }

    /// `change` is given a place from the skull's middle in mm (x to the left, y to the back, z up), its distance
    /// outside the skin, its depth under it, and the value, which it may change; it says whether the place shows.
    using Change = std::function<bool(const Vector3d& p, double out_mm, double depth_mm, float& hu)>;
    StrangeHead made(const Change& change) const {
        StrangeHead head{ct_, body_, skin_};
        for (int k = 0; k < ct_.size[2]; ++k)
            for (int j = 0; j < ct_.size[1]; ++j)
                for (int i = 0; i < ct_.size[0]; ++i) {
                    const std::size_t v = ct_.index(i, j, k);
                    const Vector3d p = ct_.ct_from_voxel * Vector3d(i, j, k) - ball_.centre_in_ct;
                    head.body.body[v] = change(p, static_cast<double>(out_mm_[v]), static_cast<double>(depth_mm_[v]),
                                               head.ct.values[v]);
                }
        return head;
    }
    StrangeHead scaled(double by) const {
        StrangeHead head{ct_, body_, skin_};
        head.ct.ct_from_voxel = Eigen::Scaling(by) * ct_.ct_from_voxel;
        for (auto& p : head.skin.vertices_in_ct) p *= by;
        return head;
    }

    /// Turned about the skull's middle.
    StrangeHead turned(StrangeHead head, double degrees, const Vector3d& about) const {
        const Eigen::Affine3d turn = Eigen::Translation3d(ball_.centre_in_ct) *
                                     Eigen::AngleAxisd(degrees * std::numbers::pi / 180, about.normalized()) *
                                     Eigen::Translation3d(-ball_.centre_in_ct);
        head.ct.ct_from_voxel = turn * head.ct.ct_from_voxel;
        for (auto& p : head.skin.vertices_in_ct) p = turn * p;
        return head;
    }

private:
    const Volume& ct_;
    const SkinMask& body_;
    const TriangleMesh& skin_;
    HeadBall ball_;
    std::vector<float> out_mm_, depth_mm_;
};

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

class Cases {
public:
    explicit Cases(std::shared_ptr<const Maker> of) : of_(std::move(of)) {}
    double radius_mm() const { return of_->radius_mm(); }
    void made(const std::string& name, Fate fate, Maker::Change change) {
        all.push_back({name, fate, [of = of_, change = std::move(change)] { return of->made(change); }});
    }
    /// Something that lies outside the skin.
    void with(const std::string& name, Fate fate, std::function<bool(const Vector3d& p, double out_mm)> is_there,
              float hu = kWet_hu) {
        made(name, fate, [is_there = std::move(is_there), hu](const Vector3d& p, double out_mm, double, float& value) {
            if (out_mm <= 0) return true;
            if (is_there(p, out_mm)) return value = hu, true;
            return false;
        });
    }
    void scaled(const std::string& name, Fate fate, double by, double coil = 0) {
        all.push_back({name, fate, [of = of_, by] { return of->scaled(by); }, coil});
    }
    void turned(const std::string& name, double degrees, const Vector3d& about) {
        all.push_back(
            {name, Fate::right, [of = of_, degrees, about] { return of->turned(of->scaled(1), degrees, about); }});
    }
    /// The case before, turned.
    void last_turned(const std::string& name, double degrees, const Vector3d& about) {
        StrangeCase strange = all.back();
        strange.name = name;
        strange.make = [of = of_, make = strange.make, degrees, about] { return of->turned(make(), degrees, about); };
        all.push_back(std::move(strange));
    }
    void in_contrast(const std::string& name, Fate fate, const MrContrast& contrast) {
        StrangeCase strange{name, fate, [of = of_] { return of->scaled(1); }};
        strange.contrast = contrast;
        strange.only_mr = true;
        all.push_back(std::move(strange));
    }
    /// The head as it is, of which the volume is spoilt after the scan.
    void spoilt(const std::string& name, Fate fate, std::function<void(Volume&)> spoil) {
        StrangeCase strange{name, fate, [of = of_] { return of->scaled(1); }};
        strange.spoil = std::move(spoil);
        strange.only_mr = true;
        all.push_back(std::move(strange));
    }
    void in_ct(const std::string& name, Fate fate, Maker::Change change) {
        made(name, fate, std::move(change));
        all.back().only_ct = true;
    }
    void solid(const std::string& name, std::function<bool(const Vector3d&)> inside) {
        made(name, Fate::refused, [inside = std::move(inside)](const Vector3d& p, double, double, float& hu) {
            hu = inside(p) ? kWet_hu : kAir_hu;
            return inside(p);
        });
    }
    std::vector<StrangeCase> all;

private:
    std::shared_ptr<const Maker> of_;
};

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
    of.in_contrast("blood alone is bright", Fate::not_bad, {"ToF", 0.35F, 0.22F, 0.03F});
}

bool in_rod(const Vector3d& p, const Vector3d& from, const Vector3d& to, double radius_mm) {
    const double along = std::clamp((p - from).dot(to - from) / (to - from).squaredNorm(), 0.0, 1.0);
    return (p - from - along * (to - from)).norm() < radius_mm;
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
    of.spoilt("moved by 9 mm", Fate::said, [](Volume& mr) { blend_with_moved(mr, {3, 7, -4.7}, 0); });
    of.spoilt("moved by 6 mm", Fate::said, [](Volume& mr) { blend_with_moved(mr, {0, 6, 0}, 0); });
    of.spoilt("moved by 4 mm and 5 degrees", Fate::said, [](Volume& mr) { blend_with_moved(mr, {0, 2, 3.5}, 5); });
    of.spoilt("moved by 9 mm for a third of the lines", Fate::said, [](Volume& mr) {
        blend_with_moved(mr, {0, 2, 8.8}, 0, 0.33);
    });
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
    Cases of(std::make_shared<const Maker>(ct, body, skin));
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
