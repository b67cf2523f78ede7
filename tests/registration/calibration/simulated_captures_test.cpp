#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "registration/calibration/calibrate_rig.h"
#include "registration/scan/decode/gray_code.h"
#include "registration/scan/scan_surface.h"
#include "tests/registration/calibration/board_scene.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

/// One room of the paper's size with five poses, seen once for all tests of this file.
class SimulatedCaptures : public testing::Test {
protected:
    static constexpr const char* kBoard = "charuco 10x7 25 mm";
    static simulation::SimulatedBoardRoom& room() {
        static simulation::BoardSheet sheet = test::printed(parse_board(kBoard));
        static simulation::SimulatedBoardRoom kept(sheet, settings());
        return kept;
    }
    static simulation::BoardRoomSettings settings() {
        simulation::BoardRoomSettings s;
        s.preset = simulation::Preset::paper;
        s.seed = 7;
        s.poses = 5;
        return s;
    }
    static const std::vector<PoseObservation>& poses() {
        static const auto seen = test::observe_room(room(), parse_board(kBoard));
        return seen;
    }
    static Calibration calibrate(const std::vector<PoseObservation>& seen) {
        return calibrate_rig(seen, parse_board(kBoard), 800, 600);
    }
};

TEST_F(SimulatedCaptures, CornersAndLightAreWhereTheSimulatorPutThem) {
    const BoardSpec board = parse_board(kBoard);
    const RigCalibration truth = room().true_rig();
    for (std::size_t i = 0; i < poses().size(); ++i) {
        const RigidTransform rig_from_board = room().true_rig_from_board(static_cast<int>(i));
        std::vector<double> corner_off, light_off;
        const auto& seen = poses()[i].left;
        for (std::size_t c = 0; c < seen.corners.size(); ++c)
            corner_off.push_back(
                (seen.corners.pixels[c] -
                 *project(truth.left_camera, rig_from_board * board.corner_in_board(seen.corners.ids[c])))
                    .norm());
        for (const LightSample& sample : seen.light) {
            const auto p =
                board_point(truth.left_camera, sample.pixel_in_camera, rig_from_board, Vector3d::Zero(), board);
            light_off.push_back((sample.pixel_in_projector - *project(truth.projector, rig_from_board * *p)).norm());
        }
        ASSERT_GT(corner_off.size(), 25u);
        ASSERT_GT(light_off.size(), 200u);
        std::sort(corner_off.begin(), corner_off.end());
        std::sort(light_off.begin(), light_off.end());
        EXPECT_LT(corner_off[corner_off.size() / 2], 0.10);
        EXPECT_LT(light_off[light_off.size() / 2], 0.15);
    }
}

TEST_F(SimulatedCaptures, FivePosesReachTheGoalsOnHeldOutPoses) {
    const Calibration found = calibrate(poses());
    ASSERT_FALSE(found.refusal) << found.refusal->reason;
    EXPECT_LT(found.held_out.rms_px[0], 0.10);
    EXPECT_LT(found.held_out.rms_px[1], 0.10);
    EXPECT_LT(found.held_out.rms_px[2], 0.20);
    EXPECT_LT(found.held_out.length_rms_mm, 0.15);
    const RigCalibration truth = room().true_rig();
    EXPECT_NEAR(found.device(DeviceName::projector)->centre_y, truth.projector.centre_y, 4)
        << "the axis leaves near the picture's lower edge";
    const RigCalibration rig = rig_calibration_of(found, "2001-01-01");
    EXPECT_NEAR((rig.right_camera.centre_in_rig() - rig.left_camera.centre_in_rig()).norm(),
                (truth.right_camera.centre_in_rig() - truth.left_camera.centre_in_rig()).norm(), 0.25);
}

TEST_F(SimulatedCaptures, ABoardThatSlipsDuringAPoseIsNoticed) {
    simulation::BoardRoomSettings one = settings();
    one.poses = 1;
    simulation::BoardSheet sheet = test::printed(parse_board(kBoard));
    simulation::SimulatedBoardRoom slipping(sheet, one);
    const auto seen = test::observe_room(slipping, parse_board(kBoard), {}, [&](int, int done) {
        if (done == 25) slipping.slip(Vector3d(0.3, 0, 0));
    });
    EXPECT_GT(seen[0].left.moved_px, 0.25);
    EXPECT_LT(poses()[0].left.moved_px, 0.1) << "and a board at rest is not";
}

TEST_F(SimulatedCaptures, SaturatedAndDimRoomsAreRefused) {
    for (const double brightness : {3.0, 0.06}) {
        simulation::BoardRoomSettings one = settings();
        one.poses = 1;
        one.brightness = brightness;
        simulation::BoardSheet sheet = test::printed(parse_board(kBoard));
        simulation::SimulatedBoardRoom bad(sheet, one);
        const auto seen = test::observe_room(bad, parse_board(kBoard));
        std::vector<PoseObservation> all = poses();
        all[0] = seen[0];
        const Calibration calibration = calibrate(all);
        ASSERT_TRUE(calibration.refusal) << brightness;
        EXPECT_NE(calibration.refusal->reason.find(brightness > 1 ? "saturated" : "too dark"), std::string::npos)
            << calibration.refusal->reason;
    }
}

TEST_F(SimulatedCaptures, ADoubledFrameIsNotDecodedInstead) {
    const BoardSpec board = parse_board(kBoard);
    room().lay(0);
    const StripeSettings stripes = test::stripes_of(room());
    ScanCapture capture = capture_scan(room().projector(), room().cameras(), room().clock(), stripes);
    for (std::size_t i = capture.left.size() - 1; i > 4; --i)
        capture.left[i] = capture.left[i - 1];  // one frame late from the fourth on
    const CameraObservation late = observe_board(capture.left, stripes, board);
    std::vector<PoseObservation> all = poses();
    all[0].left = late;
    const Calibration calibration = calibrate(all);
    EXPECT_TRUE(calibration.refusal.has_value());
}

// A pose whose light is wrong at a few places passes every judgement of residuals: they are left out, or bend the rig.
TEST_F(SimulatedCaptures, OneDoubledFrameOrTwoSwappedFringesAreNamed) {
    const BoardSpec board = parse_board(kBoard);
    room().lay(1);
    const StripeSettings stripes = test::stripes_of(room());
    const ScanCapture capture = capture_scan(room().projector(), room().cameras(), room().clock(), stripes);
    EXPECT_EQ(observe_board(capture.left, stripes, board).wrong_sequence, "");
    const auto at = [&](const std::string& name) {
        const auto sequence = stripe_sequence(stripes);
        return static_cast<std::size_t>(
            std::find_if(sequence.begin(), sequence.end(), [&](const StripePattern& p) { return p.name == name; }) -
            sequence.begin());
    };
    std::vector<GrayImage> doubled = capture.left, swapped = capture.left;
    doubled[at("column-gray-5")] = doubled[at("column-gray-4-inverse")];
    std::swap(swapped[at("row-phase-2")], swapped[at("row-phase-3")]);
    for (const auto& [frames, name] : {std::pair{&doubled, "column-gray-5"}, {&swapped, "row-phase-0"}}) {
        std::vector<PoseObservation> all = poses();
        all[1].left = observe_board(*frames, stripes, board);
        const Calibration calibration = calibrate(all);
        ASSERT_TRUE(calibration.refusal) << name;
        EXPECT_NE(calibration.refusal->reason.find(name), std::string::npos) << calibration.refusal->reason;
    }
    ObserveSettings as_they_are;
    as_they_are.check_sequence = false;
    EXPECT_EQ(observe_board(doubled, stripes, board, as_they_are).wrong_sequence, "");
}

TEST(GrayCode, DecodesItsOwnPatternsToTheirPixels) {
    const int width = 100, height = 70;
    StripeSettings stripes;
    stripes.width = width, stripes.height = height;
    const auto patterns = gray_code_patterns(stripes);
    ASSERT_EQ(patterns.size(), 2u + 2 * 7 + 2 * 7);
    std::vector<GrayImage> frames;
    for (const auto& [kind, along_rows, index, name, frequency] : patterns) {
        GrayImage frame(width, height, name == "white" ? 200 : 0);
        const bool row = name.starts_with("row"), inverse = name.ends_with("inverse");
        EXPECT_EQ(row, along_rows);
        EXPECT_EQ(inverse, kind == StripePattern::Kind::gray_bit_inverse);
        if (name.find("gray") != std::string::npos) {
            const int bit = 6 - (name[name.find("gray-") + 5] - '0');
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) {
                    const int n = row ? y : x;
                    frame.at(x, y) = ((((n ^ (n >> 1)) >> bit) & 1) != 0) != inverse ? 200 : 0;
                }
        }
        frames.push_back(std::move(frame));
    }
    GrayImage& doubtful =
        frames[2 + 2 * 6];  // the finest column bit and its inverse alike at a pixel on that bit's border
    doubtful.at(40, 3) = frames[2 + 2 * 6 + 1].at(40, 3) = 100;
    frames[2].at(20, 3) = frames[3].at(20, 3) = 100;  // the coarsest, far from its border
    const DecodedView view = decode_gray_code(frames, width, height);
    EXPECT_EQ(view.column[frames[0].index(77, 31)], 77);
    EXPECT_EQ(view.row[frames[0].index(77, 31)], 31);
    EXPECT_EQ(view.column[frames[0].index(40, 3)], 40.5F);
    EXPECT_TRUE(std::isnan(view.column[frames[0].index(20, 3)]));
    EXPECT_EQ(view.decoded, frames[0].pixels.size() - 1);
    EXPECT_THROW(decode_gray_code(std::span(frames).first(10), width, height), std::invalid_argument);
}

}  // namespace
}  // namespace planlight
