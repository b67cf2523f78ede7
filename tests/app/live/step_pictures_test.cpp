#include "app/live/step_pictures.h"

#include <gtest/gtest.h>

#include "tests/support/test_data.h"

namespace planlight {
namespace {

// A full disk: the session goes on without the picture.
TEST(StepPictures, APictureThatCannotBeKeptIsAWarningAndNoEnd) {
    const test::TemporaryFolder folder;
    const RgbImage picture(8, 6, {1, 2, 3});
    EXPECT_FALSE(keep_or_warn(picture, "/proc/operator-01-ready.png"));
    EXPECT_TRUE(keep_or_warn(picture, folder.path() / "operator-01-ready.png"));
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "operator-01-ready.png"));
}

}  // namespace
}  // namespace planlight
