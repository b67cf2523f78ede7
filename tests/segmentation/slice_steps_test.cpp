#include "segmentation/slice_steps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "planning_io/volume/read_volume.h"
#include "planning_io/volume/volume_sample.h"
#include "segmentation/skin_judgement.h"
#include "segmentation/skin_shape.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

/// From `first` on every slice lies so many voxels further along i and j.
Volume moved_from(const Volume& still, int first, int along_i, int along_j) {
    Volume moved = still;
    const float air = *std::min_element(still.values.begin(), still.values.end());
    for (int k = first; k < still.size[2]; ++k)
        for (int j = 0; j < still.size[1]; ++j)
            for (int i = 0; i < still.size[0]; ++i) {
                const int from_i = i - along_i, from_j = j - along_j;
                const bool there = from_i >= 0 && from_j >= 0 && from_i < still.size[0] && from_j < still.size[1];
                moved.values[moved.index(i, j, k)] = there ? still.at(from_i, from_j, k) : air;
            }
    return moved;
}

/// From `first` on every slice is turned by so much about its middle.
Volume turned_from(const Volume& still, int first, double radians) {
    Volume turned = still;
    const Eigen::Vector3d mm = still.spacing_mm();
    const Eigen::Vector3d middle(0.5 * (still.size[0] - 1), 0.5 * (still.size[1] - 1), 0);
    const Eigen::Affine3d back = Eigen::Translation3d(middle) * mm.cwiseInverse().asDiagonal() *
                                 Eigen::AngleAxisd(-radians, Eigen::Vector3d::UnitZ()) * mm.asDiagonal() *
                                 Eigen::Translation3d(-middle);
    const float air = *std::min_element(still.values.begin(), still.values.end());
    for (int k = first; k < still.size[2]; ++k)
        for (int j = 0; j < still.size[1]; ++j)
            for (int i = 0; i < still.size[0]; ++i)
                turned.values[turned.index(i, j, k)] = static_cast<float>(
                    value_at(still, back * Eigen::Vector3d(i, j, k)).value_or(static_cast<double>(air)));
    return turned;
}

std::optional<SliceStep> step_in(const Volume& volume) {
    const SkinMask mask = segment_skin(volume);
    return largest_slice_step(volume, mask, largest_ball(volume, mask, triangulate_skin(volume, mask)));
}

class SliceSteps : public testing::Test {
protected:
    void SetUp() override {
        if (!example_patient()) GTEST_SKIP() << "the package invesalius-examples is not installed";
        still = read_volume(*example_patient());
    }
    Volume still;
};

TEST_F(SliceSteps, AHeadThatLayStillHasNone) {
    EXPECT_FALSE(step_in(still));
}

TEST_F(SliceSteps, APatientWhoMovedIsSaidWithThePlaceAndTheSize) {
    const int first = still.size[2] / 2;
    const Eigen::Vector3d shift = still.ct_from_voxel.linear() * Eigen::Vector3d(2, -1, 0);
    const Volume moved = moved_from(still, first, 2, -1);
    const SkinMask mask = segment_skin(moved);
    const auto step = step_in(moved);
    ASSERT_TRUE(step);
    EXPECT_LT((step->shift_in_ct - shift).norm(), 0.3) << step->shift_in_ct.transpose();
    EXPECT_LT(std::abs(step->turn), 0.01);
    const Eigen::Vector3d between = still.ct_from_voxel * Eigen::Vector3d(0, 0, first - 0.5);
    EXPECT_NEAR(step->place_in_ct.z(), between.z(), 0.1);

    const SkinJudgement judged = judge_skin(moved, mask, triangulate_skin(moved, mask));
    EXPECT_TRUE(judged.refusals.empty());
    EXPECT_TRUE(std::any_of(judged.doubts.begin(), judged.doubts.end(), [](const SkinDoubt& doubt) {
        return doubt.finding.find("The patient seems to have moved") != std::string::npos;
    }));
}

TEST_F(SliceSteps, AMillimetreIsNoticed) {
    const Volume moved = moved_from(still, 40, 1, 0);
    EXPECT_TRUE(step_in(moved));
}

TEST_F(SliceSteps, ATurnIsSaidWithItsSizeAndItsSide) {
    const double turn = 3 * M_PI / 180;
    for (const double by : {turn, -turn}) {
        const auto step = step_in(turned_from(still, still.size[2] / 2, by));
        ASSERT_TRUE(step) << by;
        EXPECT_NEAR(step->turn, by, 0.01);
    }
}

// A chest is so large that slices of the head would be a small part of it, and its middle lies elsewhere.
TEST_F(SliceSteps, ShouldersBelowTheHeadDoNotHideThatItMoved) {
    Volume moved = moved_from(still, 2 * still.size[2] / 3, 4, 0);
    const Eigen::Vector3d spacing = still.spacing_mm();
    const int chest = static_cast<int>(100 / spacing.z());  // slices below the head
    Volume whole = moved;
    whole.size[2] += chest;
    whole.ct_from_voxel.translation() -= chest * still.ct_from_voxel.linear().col(2);
    whole.values.assign(static_cast<std::size_t>(whole.size[0]) * static_cast<std::size_t>(whole.size[1]) *
                            static_cast<std::size_t>(whole.size[2]),
                        *std::min_element(still.values.begin(), still.values.end()));
    for (int k = 0; k < whole.size[2]; ++k)
        for (int j = 0; j < whole.size[1]; ++j)
            for (int i = 0; i < whole.size[0]; ++i) {
                const double x = (2.0 * i / whole.size[0] - 1) / 0.95, y = (2.0 * j / whole.size[1] - 1) / 0.9;
                if (k < chest)
                    whole.values[whole.index(i, j, k)] = x * x + y * y < 1 ? 40.0F : -1000.0F;
                else
                    whole.values[whole.index(i, j, k)] = moved.at(i, j, k - chest);
            }
    const auto step = step_in(whole);
    ASSERT_TRUE(step);
    EXPECT_NEAR(step->shift_mm, 4 * spacing.x(), 0.5);
}

}  // namespace
}  // namespace planlight::test
