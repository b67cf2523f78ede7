#include <gtest/gtest.h>

#include "planning_io/case/capture_folder.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/files/image_file.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "tests/planning_io/example_rig.h"
#include "tests/support/test_data.h"

// Rigs and captures of two devices of the three.
namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

TEST(RigFile, ARigOfTwoDevicesIsReadOnlyWhereItIsEnough) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "rig.json";
    for (const bool no_right : {true, false}) {
        RigCalibration rig = test::example_rig();
        (no_right ? rig.right_camera : rig.projector) = {};
        write_rig(rig, file);
        const RigCalibration back = read_partial_rig(file);
        EXPECT_EQ(present(back.right_camera), !no_right);
        EXPECT_EQ(present(back.projector), no_right);
        EXPECT_EQ(back.left_camera.focal_x, rig.left_camera.focal_x);
        try {
            read_rig(file);
            FAIL();
        } catch (const InputError& e) {
            EXPECT_NE(std::string(e.what()).find(no_right ? "has no right_camera" : "has no projector"),
                      std::string::npos);
        }
    }
    RigCalibration alone = test::example_rig();
    alone.right_camera = alone.projector = {};
    EXPECT_THROW(write_rig(alone, file), InputError) << "a camera is no rig";
}

TEST(Recordings, ACaptureOfOneCameraAndTiffPicturesAreRead) {
    const test::TemporaryFolder folder;
    CaptureFolder capture;
    capture.projector_width = 800;
    capture.projector_height = 600;
    capture.names = {"white", "black"};
    capture.left = {GrayImage(8, 6, 9), GrayImage(8, 6, 1)};
    const fs::path at = folder.path() / "capture";
    write_capture(capture, at);
    EXPECT_FALSE(fs::exists(at / "right"));
    const CaptureFolder back = read_capture(at);
    EXPECT_TRUE(back.right.empty());
    EXPECT_EQ(back.left[0].pixels, capture.left[0].pixels);
    // The smallest TIFF: little endian, 8 x 6 of one strip, value 77.
    std::string tiff("II*\0\x38\0\0\0", 8);
    tiff.append(48, static_cast<char>(77));
    const auto number = [&](unsigned value, int bytes) {
        for (int i = 0; i < bytes; ++i) tiff.push_back(static_cast<char>(value >> (8 * i)));
    };
    const unsigned fields[][2] = {{256, 8}, {257, 6}, {258, 8}, {259, 1}, {262, 1},
                                  {273, 8}, {277, 1}, {278, 6}, {279, 48}};
    number(9, 2);
    for (const auto& field : fields) number(field[0], 2), number(4, 2), number(1, 4), number(field[1], 4);
    number(0, 4);
    fs::remove(at / "left" / "white.png");
    write_safely(at / "left" / "white.tif", tiff);
    EXPECT_EQ(read_capture(at).left[0].at(3, 2), 77);
}

}  // namespace
}  // namespace planlight
