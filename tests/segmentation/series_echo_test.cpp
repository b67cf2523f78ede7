#include "segmentation/series_echo.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "planning_io/volume/read_volume.h"
#include "tests/segmentation/spoil_volume.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

/// The CT's values with air at 0 stand for an MR's: the cepstrum asks for no contrast.
class SeriesEchoes : public testing::Test {
protected:
    void SetUp() override {
        if (!example_patient()) GTEST_SKIP() << "the package invesalius-examples is not installed";
        head = read_volume(*example_patient());
        for (float& value : head.values) value = std::clamp(value + 1000, 0.0F, 2000.0F);
    }
    Volume head;
};

TEST_F(SeriesEchoes, AHeadThatLayStillIsThereOnce) {
    const auto echo = strongest_echo(head);
    ASSERT_TRUE(echo);
    EXPECT_FALSE(echo->is_movement()) << echo->strength << " " << echo->ratio;
}

/// Within a step of the cepstrum, 2 mm along each axis; its sign is not known.
TEST_F(SeriesEchoes, ASecondImageIsFoundWhereItLies) {
    const Eigen::Vector3d by_mm(3, 7, -4.7);
    blend_with_moved(head, by_mm, 0);
    const auto echo = strongest_echo(head);
    ASSERT_TRUE(echo);
    EXPECT_TRUE(echo->is_movement()) << echo->strength << " " << echo->ratio;
    EXPECT_LT(std::min((echo->shift_in_ct - by_mm).norm(), (echo->shift_in_ct + by_mm).norm()), 2);
}

}  // namespace
}  // namespace planlight::test
