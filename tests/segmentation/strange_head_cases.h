#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "segmentation/skin_shape.h"
#include "tests/segmentation/strange_heads.h"

namespace planlight::test {

inline constexpr float kWet_hu = 40, kFat_hu = -90, kAir_hu = -1000;

/// The head that is made strange, with the distance of each voxel from its skin, mm: outwards, and under it. Keeps
/// references.
class HeadMaker {
public:
    HeadMaker(const Volume& ct, const SkinMask& body, const TriangleMesh& skin);
    double radius_mm() const { return ball_.radius_mm; }

    /// `change` is given a place from the skull's middle in mm (x to the left, y to the back, z up), its distance
    /// outside the skin, its depth under it, and the value, which it may change; it says whether the place shows.
    using Change = std::function<bool(const Eigen::Vector3d& p, double out_mm, double depth_mm, float& hu)>;
    StrangeHead made(const Change& change) const;
    StrangeHead scaled(double by) const;
    /// Turned about the skull's middle.
    StrangeHead turned(StrangeHead head, double degrees, const Eigen::Vector3d& about) const;

private:
    const Volume& ct_;
    const SkinMask& body_;
    const TriangleMesh& skin_;
    HeadBall ball_;
    std::vector<float> out_mm_, depth_mm_;
};

/// The list of cases as it grows.
class Cases {
public:
    explicit Cases(std::shared_ptr<const HeadMaker> of) : of_(std::move(of)) {}
    double radius_mm() const { return of_->radius_mm(); }

    void made(const std::string& name, Fate fate, HeadMaker::Change change);
    /// Something that lies outside the skin.
    void with(const std::string& name, Fate fate, std::function<bool(const Eigen::Vector3d& p, double out_mm)> is_there,
              float hu = kWet_hu);
    void scaled(const std::string& name, Fate fate, double by, double coil = 0);
    void turned(const std::string& name, double degrees, const Eigen::Vector3d& about);
    /// The case before, turned.
    void last_turned(const std::string& name, double degrees, const Eigen::Vector3d& about);
    void in_contrast(const std::string& name, Fate fate, const MrContrast& contrast);
    /// The head as it is, of which the volume is spoilt after the scan.
    void spoilt(const std::string& name, Fate fate, std::function<void(Volume&)> spoil);
    void in_ct(const std::string& name, Fate fate, HeadMaker::Change change);
    void solid(const std::string& name, std::function<bool(const Eigen::Vector3d&)> inside);

    std::vector<StrangeCase> all;

private:
    std::shared_ptr<const HeadMaker> of_;
};

// What lies on the head or about it (things_on_heads.cpp).
void add_things_that_lie_on_it(Cases& of);
void add_even_covers(Cases& of);
void add_what_lies_on_a_table(Cases& of);

}  // namespace planlight::test
