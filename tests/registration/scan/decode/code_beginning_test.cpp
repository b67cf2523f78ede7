#include <gtest/gtest.h>

#include <cmath>

#include "registration/scan/decode/gray_code.h"
#include "registration/scan/scan_surface.h"
#include "tests/registration/scan/solid_room.h"

// A Gray code centred in a larger power of two, as other programs show it.
namespace planlight {
namespace {

using namespace solid_room;

const Vector3d kCentre(15, -10, 640);
constexpr double kRadius_mm = 62;

struct Shot {
    Room room = desk_room(ball(kCentre, kRadius_mm), 0.7);
    ScanCapture capture;
    Shot() {
        StripeSettings stripes;
        stripes.width = room.projector.width, stripes.height = room.projector.height;
        stripes.phase_steps = 0, stripes.phase_period_px = 2;
        stripes.begins_at_column = 56, stripes.begins_at_row = 170;  // 912 and 684 in the middle of 1024
        Cameras cameras(room);
        capture = cameras.capture(stripes, gray_code_patterns(stripes));
    }
};

const Shot& shot() {
    static const Shot shot;
    return shot;
}

double rms_off(const PointCloud& cloud) {
    double squares = 0;
    for (const auto& p : cloud.points_in_rig) squares += std::pow((p - kCentre).norm() - kRadius_mm, 2);
    return std::sqrt(squares / static_cast<double>(cloud.size()));
}

TEST(CodeBeginning, IsTakenOffWhereItIsSaid) {
    const ScanResult scan = scan_from_capture(shot().capture, rig_of(shot().room));
    EXPECT_GT(scan.clean.kept.size(), 5000u);
    EXPECT_LT(rms_off(scan.clean.kept), 0.15) << "cells of one or two pixels, 0.3 mm each";
    // Taken for one that begins at 0 the same pictures fit no rig that was bumped: no light is drawn.
    ScanCapture wrong = shot().capture;
    wrong.stripes.begins_at_column = wrong.stripes.begins_at_row = 0;
    const RigState taken = scan_from_capture(wrong, rig_of(shot().room)).rig;
    EXPECT_EQ(taken.verdict, RigState::Verdict::not_trusted) << taken.sentence;
}

TEST(CodeBeginning, IsTakenOffForACalibrationAsWell) {
    const auto& capture = shot().capture;
    const DecodedView view = decode_gray_code(capture.left, capture.stripes);
    const Exposure exposure(shot().room, shot().room.left, 1);
    std::size_t looked = 0, near = 0;
    for (std::size_t i = 0; i < view.column.size(); ++i) {
        if (std::isnan(view.column[i]) || std::isnan(exposure.code()[i].x())) continue;
        ++looked;
        near += std::abs(view.column[i] - exposure.code()[i].x()) < 1.5 &&
                std::abs(view.row[i] - exposure.code()[i].y()) < 1.5;
    }
    EXPECT_GT(looked, 3000u);
    EXPECT_GT(static_cast<double>(near), 0.98 * static_cast<double>(looked));
}

}  // namespace
}  // namespace planlight
