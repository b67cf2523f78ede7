#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "planning_io/case/rig_file.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "tests/planning_io/example_rig.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

TEST(RigFile, ReadsBackValueForValueAndRefusesNonsense) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "rig.json";
    RigCalibration rig = test::example_rig();
    write_rig(rig, file);
    EXPECT_EQ(read_rig(file).serials, DeviceSerials{}) << "a file without serials, as all were";
    rig.serials = {"L-1", "", "P \"9\""};
    write_rig(rig, file);
    const RigCalibration back = read_rig(file);
    EXPECT_EQ(back.serials, rig.serials);
    EXPECT_EQ(back.left_camera.device_from_rig.matrix(), rig.left_camera.device_from_rig.matrix());
    EXPECT_EQ(back.right_camera.k3, 0.001);
    EXPECT_EQ(back.projector.centre_y, 541.1);
    EXPECT_EQ(back.made_on, "2026-01-02");
    const auto refused = [&](auto change) {
        RigCalibration bad = test::example_rig();
        change(bad);
        EXPECT_THROW(write_rig(bad, file), InputError);
    };
    refused([](RigCalibration& r) { r.left_camera.focal_x = 0; });
    refused([](RigCalibration& r) { r.projector.focal_y = -2000; });
    refused([](RigCalibration& r) { r.right_camera.width = 0; });
    refused([](RigCalibration& r) { r.right_camera.k1 = std::nan(""); });
    refused([](RigCalibration& r) { r.right_camera.device_from_rig.linear() *= 1.001; });
    refused([](RigCalibration& r) { r.right_camera.device_from_rig.linear().row(0) *= -1; });
    refused([](RigCalibration& r) { r.right_camera = r.left_camera; });
    refused([](RigCalibration& r) {
        r.projector.device_from_rig = Eigen::AngleAxisd(3.1, Vector3d::UnitY()) * r.projector.device_from_rig;
    });
    std::string text = read_whole(file);
    text.replace(text.find("\"focal_x\""), 9, "\"focal_X\"");
    write_safely(file, text);
    try {
        read_rig(file);
        FAIL();
    } catch (const InputError& e) {
        EXPECT_NE(std::string(e.what()).find(
                      "left_camera has a name that means nothing here, \"focal_X\"; is \"focal_x\" meant?"),
                  std::string::npos)
            << e.what();
    }
    write_safely(file, R"({"format": "planlight rig", "version": 2})");
    EXPECT_THROW(read_rig(file), DamagedFileError);
}

}  // namespace
}  // namespace planlight
