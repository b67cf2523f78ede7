#include "segmentation/slice_steps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "planning_io/volume/read_volume.h"
#include "segmentation/skin_judgement.h"
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

class SliceSteps : public testing::Test {
protected:
    void SetUp() override {
        if (!example_patient()) GTEST_SKIP() << "the package invesalius-examples is not installed";
        still = read_volume(*example_patient());
    }
    Volume still;
};

TEST_F(SliceSteps, AHeadThatLayStillHasNone) {
    EXPECT_FALSE(largest_slice_step(still, segment_skin(still)));
}

TEST_F(SliceSteps, APatientWhoMovedIsSaidWithThePlaceAndTheSize) {
    const int first = still.size[2] / 2;
    const Eigen::Vector3d shift = still.ct_from_voxel.linear() * Eigen::Vector3d(2, -1, 0);
    const Volume moved = moved_from(still, first, 2, -1);
    const SkinMask mask = segment_skin(moved);
    const auto step = largest_slice_step(moved, mask);
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
    EXPECT_TRUE(largest_slice_step(moved, segment_skin(moved)));
}

}  // namespace
}  // namespace planlight::test
