#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "segmentation/segment_skin.h"
#include "tests/segmentation/analytic_heads.h"

// MR heads in volumes of which a part was set to one value: by padding, by a correction of the gradients, by a mask.
namespace planlight::test {
namespace {

using Eigen::Vector3d;

/// The egg of `depth_in_head`, or what has another depth, as an MR shows it in noisy air, with `spoil` done to each
/// value by where it lies.
Volume mr_head(
    const std::function<float(const Vector3d& place, float value)>& spoil,
    const std::function<double(const Vector3d&)>& depth = [](const Vector3d& p) { return depth_in_head(p); }) {
    Volume mr = mr_of([&](const Vector3d& p) { return layered(depth(p)); }, {125, 145, 125}, 24);
    for (int k = 0; k < mr.size[2]; ++k)
        for (int j = 0; j < mr.size[1]; ++j)
            for (int i = 0; i < mr.size[0]; ++i) {
                float& value = mr.values[mr.index(i, j, k)];
                value = spoil(mr.ct_from_voxel * Vector3d(i, j, k), value);
            }
    return mr;
}

/// Share of the skin found that lies more than 2 mm off the egg.
double share_off(const Volume& mr, const SkinMask& mask) {
    const TriangleMesh skin = triangulate_skin(mr, mask);
    std::size_t off = 0;
    for (const Vector3d& p : skin.vertices_in_ct) off += std::abs(depth_in_head(p)) > 2;
    return static_cast<double>(off) / static_cast<double>(skin.vertices_in_ct.size());
}

TEST(BlankBorder, OfZeroRoundNoisyAirHidesNoHead) {
    const auto padded = [](const Vector3d& p, float value) {
        return (p.cwiseAbs().array() > Vector3d(112, 130, 110).array()).any() ? 0 : value;
    };
    const Volume mr = mr_head(padded);
    EXPECT_LT(share_off(mr, segment_skin(mr)), 0.01);
}

TEST(BlankBorder, CurvedByGradientCorrectionHidesNoHead) {
    const auto straightened = [](const Vector3d& p, float value) {
        const Vector3d r = p.cwiseQuotient(Vector3d(125, 145, 125)).cwiseAbs2();
        const bool blank = ((r.cwiseSqrt().array() - 0.98 + 0.07 * (r.sum() - r.array())) > 0).any();
        return blank ? 0 : value;
    };
    const Volume mr = mr_head(straightened);
    EXPECT_LT(share_off(mr, segment_skin(mr)), 0.01);
}

/// A neck goes on below the head until a border of zeros ends it: what is found there is an end, not skin.
TEST(BlankBorder, EndsANeckWhereItBegins) {
    const double end_mm = -105, neck_mm = 55;
    for (const bool curved : {false, true}) {
        const auto depth = [&](const Vector3d& p) {
            return std::max(depth_in_head(p), p.z() < 0 ? neck_mm - std::hypot(p.x(), p.y()) : -1e3);
        };
        const auto end_at = [&](const Vector3d& p) {
            return end_mm + (curved ? 0.0006 * (p.x() * p.x() + p.y() * p.y()) : 0);
        };
        const auto ended = [&](const Vector3d& p, float value) {
            return p.z() < end_at(p) || (p.cwiseAbs().array() > Vector3d(115, 130, 115).array()).any() ? 0 : value;
        };
        const Volume mr = mr_head(ended, depth);
        const TriangleMesh skin = triangulate_skin(mr, segment_skin(mr));
        std::size_t at_end = 0, told = 0, aside = 0, wrong = 0;
        for (std::size_t v = 0; v < skin.vertices_in_ct.size(); ++v) {
            const Vector3d& p = skin.vertices_in_ct[v];
            if (std::abs(p.z() - end_at(p)) < 3 && depth(p) > 3)
                ++at_end, told += skin.flags[v] != kSkin;
            else if (p.z() > end_at(p) + 6)
                ++aside, wrong += skin.flags[v] == kCutPlane;
        }
        ASSERT_GT(at_end, 1000u);
        EXPECT_GT(static_cast<double>(told), 0.97 * static_cast<double>(at_end)) << curved;
        EXPECT_LT(static_cast<double>(wrong), 0.002 * static_cast<double>(aside)) << curved;
    }
}

TEST(BlankBorder, IsNoneWhereAirWasCutToZeroButForSpecks) {
    const auto cut = [](const Vector3d&, float value) { return value < 50 ? 0 : value; };
    const Volume mr = mr_head(cut);
    const std::size_t air = mr.index(0, 0, 8);  // slices below the head
    std::size_t specks = 0;
    for (std::size_t v = 0; v < air; ++v) specks += mr.values[v] > 0;
    EXPECT_GT(static_cast<double>(specks), 0.05 * static_cast<double>(air));
    const SkinMask mask = segment_skin(mr);
    EXPECT_FALSE(mask.blank);
    EXPECT_LT(share_off(mr, mask), 0.01);
}

TEST(BlankBorder, IsNoneWhereAllAirIsOfOneValue) {
    const auto masked = [](const Vector3d& p, float value) { return depth_in_head(p) < -2 ? 0 : value; };
    const Volume mr = mr_head(masked);
    const SkinMask mask = segment_skin(mr);
    EXPECT_FALSE(mask.blank);
    EXPECT_LT(share_off(mr, mask), 0.01);
}

}  // namespace
}  // namespace planlight::test
