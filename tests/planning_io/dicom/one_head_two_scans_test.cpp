#include <gtest/gtest.h>

#include "planning_io/volume/read_volume.h"
#include "tests/planning_io/surface_distance.h"
#include "tests/planning_io/volume_cases.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

Volume scanned(const Grid& grid, const char* folder_name, const TemporaryFolder& folder) {
    write_series(synthetic_series(grid), folder.path() / folder_name);
    return read_volume(folder.path() / folder_name);
}

/// The phantom has voxels of 3 x 3 x 4 mm, and skull and skin change from 1000 to 40 HU and less between two of them:
/// its surface is a staircase of voxels, and two scans of it differ by a quarter of a voxel where the data end. A tilt
/// forgotten costs centimetres.
TEST(OneHeadTwoScans, StraightAndTiltedShowOneSkullInOneFrame) {
    const TemporaryFolder folder;
    const Volume straight = scanned({}, "straight", folder);
    Volume tilted = scanned(turned_grid(Eigen::Matrix3d::Identity(), -4.0 / 3), "tilted", folder);
    const SurfaceDistance apart = surface_distance(tilted, straight, 200);
    EXPECT_GT(apart.points, 3000);
    EXPECT_LT(apart.median_mm, 0.75) << "a quarter of a voxel of 3 mm";
    tilted.ct_from_voxel.linear().col(2).y() = 0;  // the tilt forgotten, as common readers do
    EXPECT_GT(surface_distance(tilted, straight, 200).median_mm, 2 * apart.median_mm);
}

/// The same skull phantom scanned straight (5 mm slices) and with -18.5 degrees of tilt (2.5 mm): half a thick slice
/// is 2.5 mm, and bone at 200 HU is blurred by it; 0.9 mm is what two such scans of one skull agree to.
TEST(OneHeadTwoScans, ThePhilipsPhantomStraightAndTilted) {
    const auto plain = third_party_data("ct/philips_skull_phantom/plain_5mm"),
               tilt = third_party_data("ct/philips_skull_phantom/tilt_minus18p5");
    if (!plain || !tilt) GTEST_SKIP() << "the phantom is not here";
    const Volume a = read_volume(*plain), b = read_volume(*tilt);
    EXPECT_EQ(a.frame_of_reference_uid, b.frame_of_reference_uid);
    EXPECT_LT(surface_distance(a, b, 200).median_mm, 0.9);
}

}  // namespace
}  // namespace planlight::test
