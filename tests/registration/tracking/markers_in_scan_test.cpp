#include "registration/tracking/markers_in_scan.h"

#include <gtest/gtest.h>

#include "marker_scene.h"
#include "tests/registration/gray_columns.h"

namespace planlight::test {
namespace {

constexpr int kBits = 5;

/// White, black, the bits without inverses and five shifts of a fringe: what the fast set shows.
std::vector<StripePattern> fast_columns() {
    std::vector<StripePattern> patterns;
    for (const StripePattern& pattern : gray_columns(kBits))
        if (pattern.kind != StripePattern::Kind::gray_bit_inverse) patterns.push_back(pattern);
    for (int step = 0; step < 5; ++step)
        patterns.push_back({StripePattern::Kind::phase, false, step, "column-phase-" + std::to_string(step)});
    return patterns;
}

/// A Gray code of columns on a head whose pose is `at(share)` when a share of the pictures is taken; stripes as seen
/// from the left camera and the right one, hard over the markers too.
ScanCapture capture_of(const RigCalibration& rig, const std::function<RigidTransform(double)>& at,
                       bool with_stickers = true, const std::vector<StripePattern>& patterns = gray_columns(kBits),
                       const Look& look = {}) {
    ScanCapture capture;
    capture.stripes.width = 800;
    capture.stripes.height = 600;
    capture.stripes.rows = false;
    capture.partial = patterns;
    std::mt19937 random(3);
    for (std::size_t k = 0; k < capture.partial.size(); ++k) {
        const double share = static_cast<double>(k) / static_cast<double>(capture.partial.size() - 1);
        auto stickers = moved(at(share) * RigidTransform(Eigen::Translation3d(head_centre())), stickers_on_head());
        if (!with_stickers) stickers.clear();
        const StereoFrame lit = render_frame(rig, stickers, look, {}, random);
        const auto under_stripes = [&](const GrayImage& picture) {
            GrayImage striped = picture;
            const auto kind = capture.partial[k].kind;
            for (int y = 0; y < picture.height; ++y)
                for (int x = 0; x < picture.width; ++x) {
                    double light = kind == StripePattern::Kind::white ? 1 : 0;
                    if (kind == StripePattern::Kind::phase) {
                        light = 0.5 + 0.5 * std::cos(2 * M_PI * (x / 24.0 - capture.partial[k].index / 5.0));
                    } else if (k >= 2) {
                        const int stripe = (x * 32 / picture.width) >> (kBits - 1 - capture.partial[k].index);
                        light = (stripe % 2 == 0) == (kind == StripePattern::Kind::gray_bit) ? 1 : 0;
                    }
                    striped.at(x, y) = static_cast<std::uint8_t>(picture.at(x, y) * (1 + 7 * light) / 8);
                }
            return striped;
        };
        capture.left.push_back(under_stripes(lit.left));
        capture.right.push_back(under_stripes(lit.right));
    }
    capture.ended = std::chrono::milliseconds(500);
    return capture;
}

TEST(MarkersInScan, AHeadAtRestAndOneThatMoves) {
    const RigCalibration rig = paper_rig();
    const ScanMovement rest =
        movement_of_markers(capture_of(rig, [](double) { return RigidTransform::Identity(); }), rig);
    ASSERT_EQ(rest.by, ScanMovement::By::markers);
    EXPECT_EQ(rest.markers, 6);
    EXPECT_EQ(rest.moments, 1 + kBits);
    EXPECT_LT(rest.moved_mm, 0.06) << "half a pair's contrast, noise 2 grey; the limit of a scan is 0.15";
    for (const Eigen::Vector3d& way : {Eigen::Vector3d(0.3, 0, 0), Eigen::Vector3d(0, 0, 0.3)}) {
        const ScanMovement movement = movement_of_markers(
            capture_of(rig, [&](double share) { return RigidTransform(Eigen::Translation3d(share * way)); }), rig);
        // The moments span 10 of 11 steps.
        EXPECT_NEAR(movement.moved_mm, 0.27, 0.06) << way.transpose();
        EXPECT_EQ(movement.from, "white");
    }
}

// Markers that are just followed under white have half that contrast in the pictures of the scan: a head that goes away
// and comes back must be seen to.
TEST(MarkersInScan, DimMarkersThatAreFollowedUnderWhiteAreSeenInTheScan) {
    const RigCalibration rig = paper_rig();
    Look dim;
    dim.light = 0.1;
    dim.noise = 1;
    const auto away = [](double share) {
        return RigidTransform(Eigen::Translation3d(share > 0.2 && share < 0.8 ? 2 : 0, 0, 0));
    };
    const ScanCapture capture = capture_of(rig, away, true, gray_columns(kBits), dim);
    PatientTracker tracker(rig);
    tracker.set_reference(StereoFrame{capture.left.front(), capture.right.front(), {}, {}, 0});
    ASSERT_GE(tracker.markers().size(), 5u);
    const ScanMovement movement = movement_of_markers(capture, rig);
    EXPECT_EQ(movement.by, ScanMovement::By::markers);
    EXPECT_NEAR(movement.moved_mm, 2, 0.3);
}

// Even light at both ends of the sequence, and none between: what moved from one to the other is measured.
TEST(MarkersInScan, OfTheFastSetAreMeasuredAtItsEnds) {
    const RigCalibration rig = paper_rig();
    const auto fast = [&](double way_mm) {
        return movement_of_markers(
            capture_of(
                rig, [&](double share) { return RigidTransform(Eigen::Translation3d(share * way_mm, 0, 0)); }, true,
                fast_columns()),
            rig);
    };
    const ScanMovement rest = fast(0), moved = fast(0.4);
    ASSERT_EQ(rest.by, ScanMovement::By::markers);
    EXPECT_EQ(rest.markers, 6);
    EXPECT_EQ(rest.moments, 2);
    EXPECT_LT(rest.moved_mm, 0.06);
    EXPECT_NEAR(moved.moved_mm, 0.4 * (9 - 0.5) / 11, 0.08) << "white and black are at 0.5, the fringes about 9 of 11";
}

/// A step stays; the finest stripes shift a slanted marker in their own picture alone.
TEST(MarkersInScan, AStepIsAMovementAndOneOddMomentIsNone) {
    const RigCalibration rig = paper_rig();
    const auto moved_by = [&](const std::function<double(double)>& way_mm) {
        return movement_of_markers(
                   capture_of(rig,
                              [&](double share) { return RigidTransform(Eigen::Translation3d(way_mm(share), 0, 0)); }),
                   rig)
            .moved_mm;
    };
    EXPECT_NEAR(moved_by([](double share) { return share > 0.55 ? 0.3 : 0.0; }), 0.3, 0.06);
    EXPECT_NEAR(moved_by([](double share) { return share > 0.85 ? 0.3 : 0.0; }), 0.3, 0.06) << "the last moment counts";
    EXPECT_LT(moved_by([](double share) { return share > 0.5 && share < 0.68 ? 0.3 : 0.0; }), 0.1);
}

TEST(MarkersInScan, ATurnIsAMovement) {
    const RigCalibration rig = paper_rig();
    const ScanMovement movement = movement_of_markers(capture_of(rig,
                                                                 [](double share) {
                                                                     return head_move({0, 0.3 * share, 0}, {0, 0, 0});
                                                                 }),
                                                      rig);
    EXPECT_NEAR(movement.turned, 0.3 * M_PI / 180 * 10 / 11, 0.0015);
    EXPECT_GT(movement.moved_mm, 0.15) << "0.3 degrees at 80 mm are 0.4 mm";
}

// A hand or a drape comes over the markers: what they said before it is not how the patient lay.
TEST(MarkersInScan, OnesThatAreSeenAtTheBeginningAloneDoNotSayThatThePatientLayStill) {
    const RigCalibration rig = paper_rig();
    const auto at = [](double share) { return RigidTransform(Eigen::Translation3d(share > 0.5 ? 2 : 0, 0, 0)); };
    ScanCapture capture = capture_of(rig, at);
    EXPECT_TRUE(movement_of_markers(capture, rig).throughout);
    const ScanCapture without = capture_of(rig, at, false);
    for (std::size_t k = 6; k < capture.left.size(); ++k)
        capture.left[k] = without.left[k], capture.right[k] = without.right[k];
    const ScanMovement of_markers = movement_of_markers(capture, rig);
    ASSERT_EQ(of_markers.by, ScanMovement::By::markers);
    EXPECT_LT(of_markers.moved_mm, 0.06);
    EXPECT_FALSE(of_markers.throughout);
    PointCloud skin;
    skin.points_in_rig = {head_centre()};
    const ScanMovement movement = movement_in_scan(capture, rig, skin);
    EXPECT_FALSE(movement.by == ScanMovement::By::markers && movement.throughout);
    EXPECT_TRUE(movement.by != ScanMovement::By::pictures || movement.way_mm() > 0.5) << movement.way_mm();
}

TEST(MarkersInScan, WithoutMarkersOrASecondCameraItIsNotKnown) {
    const RigCalibration rig = paper_rig();
    const auto rest = [](double) { return RigidTransform::Identity(); };
    EXPECT_EQ(movement_of_markers(capture_of(rig, rest, false), rig).by, ScanMovement::By::nothing);
    ScanCapture left_only = capture_of(rig, rest);
    left_only.right.clear();
    EXPECT_EQ(movement_of_markers(left_only, rig).by, ScanMovement::By::nothing);
}

}  // namespace
}  // namespace planlight::test
