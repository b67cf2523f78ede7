#include "tests/segmentation/strange_head_cases.h"

#include <numbers>
#include <utility>

#include "segmentation/distance_transform.h"
#include "segmentation/head_survey.h"

namespace planlight::test {

using Eigen::Vector3d;

HeadMaker::HeadMaker(const Volume& ct, const SkinMask& body, const TriangleMesh& skin)
    : ct_(ct), body_(body), skin_(skin), ball_(largest_ball(ct, body, skin)) {
    const VoxelGrid grid = grid_of(ct);
    out_mm_ = distance_from(body.body, 1, grid, 60);
    depth_mm_ = distance_from(body.body, 0, grid, 60);
}

StrangeHead HeadMaker::made(const Change& change) const {
    StrangeHead head{ct_, body_, skin_};
    for (int k = 0; k < ct_.size[2]; ++k)
        for (int j = 0; j < ct_.size[1]; ++j)
            for (int i = 0; i < ct_.size[0]; ++i) {
                const std::size_t v = ct_.index(i, j, k);
                const Vector3d p = ct_.ct_from_voxel * Vector3d(i, j, k) - ball_.centre_in_ct;
                head.body.body[v] =
                    change(p, static_cast<double>(out_mm_[v]), static_cast<double>(depth_mm_[v]), head.ct.values[v]);
            }
    return head;
}

StrangeHead HeadMaker::scaled(double by) const {
    StrangeHead head{ct_, body_, skin_};
    head.ct.ct_from_voxel = Eigen::Scaling(by) * ct_.ct_from_voxel;
    for (auto& p : head.skin.vertices_in_ct) p *= by;
    return head;
}

StrangeHead HeadMaker::turned(StrangeHead head, double degrees, const Vector3d& about) const {
    const Eigen::Affine3d turn = Eigen::Translation3d(ball_.centre_in_ct) *
                                 Eigen::AngleAxisd(degrees * std::numbers::pi / 180, about.normalized()) *
                                 Eigen::Translation3d(-ball_.centre_in_ct);
    head.ct.ct_from_voxel = turn * head.ct.ct_from_voxel;
    for (auto& p : head.skin.vertices_in_ct) p = turn * p;
    return head;
}

void Cases::made(const std::string& name, Fate fate, HeadMaker::Change change) {
    all.push_back({name, fate, [of = of_, change = std::move(change)] { return of->made(change); }});
}

void Cases::with(const std::string& name, Fate fate, std::function<bool(const Vector3d& p, double out_mm)> is_there,
                 float hu) {
    made(name, fate, [is_there = std::move(is_there), hu](const Vector3d& p, double out_mm, double, float& value) {
        if (out_mm <= 0) return true;
        if (is_there(p, out_mm)) return value = hu, true;
        return false;
    });
}

void Cases::scaled(const std::string& name, Fate fate, double by, double coil) {
    all.push_back({name, fate, [of = of_, by] { return of->scaled(by); }, coil});
}

void Cases::turned(const std::string& name, double degrees, const Vector3d& about) {
    all.push_back(
        {name, Fate::right, [of = of_, degrees, about] { return of->turned(of->scaled(1), degrees, about); }});
}

void Cases::last_turned(const std::string& name, double degrees, const Vector3d& about) {
    StrangeCase strange = all.back();
    strange.name = name;
    strange.make = [of = of_, make = strange.make, degrees, about] { return of->turned(make(), degrees, about); };
    all.push_back(std::move(strange));
}

void Cases::in_contrast(const std::string& name, Fate fate, const MrContrast& contrast) {
    scaled(name, fate, 1);
    all.back().contrast = contrast;
    all.back().only_mr = true;
}

void Cases::spoilt(const std::string& name, Fate fate, std::function<void(Volume&)> spoil) {
    scaled(name, fate, 1);
    all.back().spoil = std::move(spoil);
    all.back().only_mr = true;
}

void Cases::in_ct(const std::string& name, Fate fate, HeadMaker::Change change) {
    made(name, fate, std::move(change));
    all.back().only_ct = true;
}

void Cases::solid(const std::string& name, std::function<bool(const Vector3d&)> inside) {
    made(name, Fate::refused, [inside = std::move(inside)](const Vector3d& p, double, double, float& hu) {
        hu = inside(p) ? kWet_hu : kAir_hu;
        return inside(p);
    });
}

}  // namespace planlight::test
