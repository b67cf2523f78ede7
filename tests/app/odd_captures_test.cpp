#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "planning_io/recording_files.h"
#include "planning_io/rig_file.h"
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
        return static_cast<std::size_t>(std::find(capture_.names.begin(), capture_.names.end(), name) - capture_.names.begin());
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
    expect_refused(scan(capture_, rig_, "--accept-movement"), 6, "column-gray-5 and its inverse do not complete each other");
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

TEST_F(GrayCodeFolder, OfColumnsOnlyNeedsTwoCameras) {
    for (std::size_t i = capture_.names.size(); i-- > 0;)
        if (capture_.names[i].starts_with("row")) {
            const auto k = static_cast<std::ptrdiff_t>(i);
            capture_.names.erase(capture_.names.begin() + k);
            capture_.left.erase(capture_.left.begin() + k);
            capture_.right.erase(capture_.right.begin() + k);
        }
    capture_.rows = false;
    EXPECT_EQ(scan(capture_, rig_).exit_code, 0);
    capture_.right.clear();
    expect_refused(scan(capture_, rig_), 3, "columns only, and there is one camera");
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
    expect_refused(run_planlight(size + "--set fast --phase-steps 9 --out new", root), 3, "its own number of shifts");
    expect_refused(run_planlight(size + "--set multi-frequency --phase-period-px 20 --out new", root), 3, "its own periods");
    expect_refused(run_planlight("patterns --width 8192 --height 8192 --set multi-frequency --out new", root), 3, "8192 x 8192");
    EXPECT_FALSE(fs::exists(root / "new"));
}

}  // namespace
}  // namespace planlight::test
