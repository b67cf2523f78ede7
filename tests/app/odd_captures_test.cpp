#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "planning_io/case/capture_folder.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/files/image_file.h"
#include "planning_io/surface/mesh_file.h"
#include "tests/app/run_command.h"
#include "tests/registration/scan/stripe_room.h"
#include "tests/support/test_data.h"

// Captures of others that are not what they say: refused by name, and nothing is written.
namespace planlight::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A ball under a Gray code with inverses and without fringes, as others show it; cells of 8 projector pixels.
class GrayCodeFolder : public testing::Test {
protected:
    GrayCodeFolder() : room_(stripe_room::paper_room(stripe_room::sphere({120, -40, 360}, 80))) {
        const StripeSettings stripes = stripe_room::stripes_of(room_);
        const ScanCapture shot = stripe_room::capture(room_, stripes);
        capture_.projector_width = stripes.width;
        capture_.projector_height = stripes.height;
        const auto sequence = stripe_sequence(stripes);
        for (std::size_t i = 0; i < sequence.size(); ++i) {
            if (sequence[i].kind == StripePattern::Kind::phase) continue;
            capture_.names.push_back(sequence[i].name);
            capture_.left.push_back(shot.left[i]);
            capture_.right.push_back(shot.right[i]);
        }
        rig_ = stripe_room::rig_of(room_);
    }

    std::size_t at(const std::string& name) const {
        return static_cast<std::size_t>(std::find(capture_.names.begin(), capture_.names.end(), name) -
                                        capture_.names.begin());
    }

    void leave_out(std::size_t i) {
        const auto k = static_cast<std::ptrdiff_t>(i);
        capture_.names.erase(capture_.names.begin() + k);
        capture_.left.erase(capture_.left.begin() + k);
        capture_.right.erase(capture_.right.begin() + k);
    }

    CommandRun scan(const CaptureFolder& capture, const RigCalibration& rig, const std::string& more = "") {
        fs::remove_all(root() / "capture");
        write_capture(capture, root() / "capture");
        write_rig(rig, root() / "rig.json");
        return run_planlight("scan capture --rig rig.json --out cloud.ply " + more, root());
    }
    const fs::path& root() const { return folder_.path(); }

    TemporaryFolder folder_;
    stripe_room::Room room_;
    CaptureFolder capture_;
    RigCalibration rig_;
};

TEST_F(GrayCodeFolder, IsScannedByOneCameraAndADoubledFrameIsRefusedByItsName) {
    capture_.right.clear();
    const auto good = scan(capture_, rig_);
    EXPECT_EQ(good.exit_code, 0) << good.err;
    fs::remove(root() / "cloud.ply");
    capture_.left[at("column-gray-5")] = capture_.left[at("column-gray-4-inverse")];
    expect_refused(scan(capture_, rig_, "--accept-movement"), 6,
                   "column-gray-5 and its inverse do not complete each other");
    EXPECT_FALSE(fs::exists(root() / "cloud.ply"));
    capture_.check_sequence = false;  // said to be right whatever it looks like
    EXPECT_EQ(scan(capture_, rig_, "--accept-movement").exit_code, 0);
}

// Points that lie on the rays of a wrong rig by chance are no cloud.
TEST_F(GrayCodeFolder, OfAnotherRigIsRefused) {
    RigCalibration turned = rig_;
    turned.right_camera.device_from_rig.linear() = rig_.right_camera.device_from_rig.linear().transpose().eval();
    expect_refused(scan(capture_, turned), 6, "does not fit the rig file");
    CaptureFolder other_camera = capture_;
    other_camera.left = capture_.right;
    other_camera.right.clear();
    expect_refused(scan(other_camera, rig_), 6, "does not fit the rig file");
    EXPECT_FALSE(fs::exists(root() / "cloud.ply"));
}

// One camera and planes of light: an ordinary scanner. Nothing checks its points, and that is said.
TEST_F(GrayCodeFolder, OfColumnsOnlyIsScannedByPlanesOfLight) {
    for (std::size_t i = capture_.names.size(); i-- > 0;)
        if (capture_.names[i].starts_with("row")) leave_out(i);
    capture_.rows = false;
    const auto both = scan(capture_, rig_);
    EXPECT_EQ(both.exit_code, 0) << both.err;
    EXPECT_EQ(both.err.find("nothing checks it"), std::string::npos);
    capture_.right.clear();
    const auto one = scan(capture_, rig_);
    EXPECT_EQ(one.exit_code, 0) << one.err;
    EXPECT_NE(one.err.find("nothing checks it"), std::string::npos) << one.err;
    const PointCloud cloud = read_cloud(root() / "cloud.ply");
    EXPECT_GT(cloud.size(), 10000u);
    double mean = 0;  // cells of 8 pixels flatten a ball by a quarter of a millimetre (scan/ACCURACY.md)
    for (const auto& p : cloud.points_in_rig)
        mean += (p - Eigen::Vector3d(120, -40, 360)).norm() / static_cast<double>(cloud.size());
    EXPECT_NEAR(mean, 80, 0.6);
}

// All that is missing at once, before any picture is read, and what goes with it.
TEST_F(GrayCodeFolder, WithMissingPicturesIsRefusedWithAllOfThemOrReadAsFarAsItCanBe) {
    write_capture(capture_, root() / "capture");
    write_rig(rig_, root() / "rig.json");
    for (const char* name : {"left/column-gray-5", "left/column-gray-5-inverse", "right/row-gray-6"})
        fs::remove(root() / "capture" / (std::string(name) + ".png"));
    std::ofstream(root() / "capture/left/white.png")
        << "no picture";  // would be refused first if pictures were read first
    const std::string command = "scan capture --rig rig.json --out cloud.ply ";
    const auto refused = run_planlight(command, root());
    expect_refused(refused, 3,
                   "3 pictures are missing: left/column-gray-5, left/column-gray-5-inverse, right/row-gray-6");
    EXPECT_NE(refused.err.find("column-gray-6, column-gray-6-inverse"), std::string::npos) << refused.err;
    EXPECT_NE(refused.err.find("--allow-missing"), std::string::npos) << refused.err;
    write_png(capture_.left[0], root() / "capture/left/white.png");
    const auto allowed = run_planlight(command + "--allow-missing --json", root());
    EXPECT_EQ(allowed.exit_code, 0) << allowed.err;
    EXPECT_NE(allowed.err.find("are left out"), std::string::npos) << allowed.err;
    EXPECT_EQ(json::parse(allowed.out).at("code_step_px"), 32) << "two bits coarser than 8 pixels, by the columns";
    // Of the right camera nothing is left: the left one and the projector.
    fs::remove(root() / "capture/right/black.png");
    const auto one = run_planlight(command + "--allow-missing --json", root());
    EXPECT_EQ(one.exit_code, 0) << one.err;
    EXPECT_EQ(json::parse(one.out).at("devices"), "one camera and the projector");
    fs::remove(root() / "capture/left/black.png");
    expect_refused(run_planlight(command + "--allow-missing", root()), 3, "nothing can be read without them");
}

// What another's capture.json need not say: the names tell it.
TEST_F(GrayCodeFolder, IsUnderstoodByTheNamesOfItsPictures) {
    scan(capture_, rig_);
    const json whole_settings = json::parse(whole(root() / "capture/capture.json"));
    for (const bool with_names : {true, false}) {
        json settings{{"format", "planlight capture"},
                      {"version", 1},
                      {"projector_width", 800},
                      {"projector_height", 600},
                      {"phase_period_px", 16}};
        if (with_names) settings["names"] = whole_settings.at("names");
        settings["phase_steps"] = 8;  // the sequence was ours, and its fringes are missing
        std::ofstream(root() / "capture/capture.json") << settings;
        const auto run = run_planlight("scan capture --rig rig.json --out cloud.ply --json", root());
        EXPECT_EQ(run.exit_code, 0) << run.err;
        EXPECT_EQ(json::parse(run.out).at("code_step_px"), 8);
    }
}

/// A left lens that was focused anew (0.5 % of its focal length) bends the cloud by millimetres, while most of what it
/// still keeps looks well: the scan itself says so. In what `check` prints of a projector that
/// it could not place there is no 0, which would read as a perfect one.
TEST(ScanCommand, SaysThatTheCamerasDoNotFitEachOther) {
    const TemporaryFolder folder;
    const auto room = stripe_room::paper_room(stripe_room::sphere({120, -40, 360}, 80));
    const StripeSettings stripes = stripe_room::stripes_of(room);
    const ScanCapture shot = stripe_room::capture(room, stripes);
    CaptureFolder capture;
    capture.projector_width = stripes.width, capture.projector_height = stripes.height;
    capture.phase_steps = stripes.phase_steps, capture.phase_period_px = stripes.phase_period_px;
    for (const StripePattern& pattern : stripe_sequence(stripes)) capture.names.push_back(pattern.name);
    capture.left = shot.left, capture.right = shot.right;
    write_capture(capture, folder.path() / "capture");
    const RigCalibration rig = stripe_room::rig_of(room);
    write_rig(rig, folder.path() / "rig.json");
    const char* const words = "cameras do not fit each other";
    const auto good = run_planlight("scan capture --rig rig.json --out cloud.ply", folder.path());
    EXPECT_EQ(good.exit_code, 0) << good.err;
    EXPECT_EQ(good.err.find(words), std::string::npos) << good.err;
    RigCalibration refocused = rig;
    refocused.left_camera.focal_x *= 1.005, refocused.left_camera.focal_y *= 1.005;
    write_rig(refocused, folder.path() / "rig.json");
    const auto focused = run_planlight("scan capture --rig rig.json --out cloud.ply", folder.path());
    EXPECT_NE(focused.err.find("its lens was changed"), std::string::npos) << focused.err;
    RigCalibration turned = rig;
    const Eigen::AngleAxisd upwards(0.02, Eigen::Vector3d::UnitX());
    turned.right_camera.device_from_rig = RigidTransform(upwards) * turned.right_camera.device_from_rig;
    write_rig(turned, folder.path() / "rig.json");
    const auto checked = run_planlight("check capture --rig rig.json --json", folder.path());
    EXPECT_EQ(checked.exit_code, 6);
    const json result = json::parse(checked.out);
    EXPECT_GT(result.at("epipolar_px").get<double>(), 1);
    for (const char* name :
         {"projector_rms_px", "projector_after_px", "light_off_mm", "projector_moved_mm", "camera_k1_off"})
        EXPECT_TRUE(result.at(name).is_null()) << name;
    EXPECT_EQ(run_planlight("check capture --rig rig.json", folder.path()).exit_code, 6)
        << "the log with nulls is read back";
}

TEST(PatternsCommand, WritesTheSettingsOfItsCapturesAndNothingOverAnother) {
    const TemporaryFolder folder;
    const fs::path& root = folder.path();
    const std::string size = "patterns --width 320 --height 240 ";
    ASSERT_EQ(run_planlight(size + "--columns-only --out columns", root).exit_code, 0);
    const CaptureFolder settings = read_capture_settings(root / "columns/capture.json");
    EXPECT_FALSE(settings.rows);
    EXPECT_EQ(settings.names.size(), 2u + 2u * 6u + 8u);
    for (const std::string& name : settings.names) EXPECT_TRUE(fs::exists(root / "columns" / (name + ".png"))) << name;
    EXPECT_FALSE(fs::exists(root / "columns/row-gray-0.png"));

    const std::string before = whole(root / "columns/patterns.json");
    expect_refused(run_planlight(size + "--set fast --out columns", root), 3, "exists already");
    EXPECT_EQ(whole(root / "columns/patterns.json"), before);
    expect_refused(run_planlight(size + "--set fast --phase-steps 9 --out new", root), 2, "its own number of shifts");
    expect_refused(run_planlight(size + "--set multi-frequency --phase-period-px 20 --out new", root), 2,
                   "its own periods");
    expect_refused(run_planlight("patterns --width 8192 --height 8192 --set multi-frequency --out new", root), 3,
                   "8192 x 8192");
    EXPECT_FALSE(fs::exists(root / "new"));
}

}  // namespace
}  // namespace planlight::test
