#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "registration/scan/scan_surface.h"
#include "tests/registration/scan/stripe_room.h"

namespace planlight {
namespace {

using namespace stripe_room;

const Eigen::Vector3d kCentre(120, -40, 360);
constexpr double kRadius_mm = 80;

struct Shot {
    Room room;
    ScanCapture capture;
    RigCalibration rig;
};

Shot shot_of(Room room, const StripeSettings& stripes) {
    Shot shot{std::move(room), {}, {}};
    shot.capture = capture(shot.room, stripes);
    shot.rig = rig_of(shot.room);
    return shot;
}

const Shot& ball() {
    static const Shot shot = [] {
        Room room = paper_room(sphere(kCentre, kRadius_mm));
        const StripeSettings stripes = stripes_of(room);
        return shot_of(std::move(room), stripes);
    }();
    return shot;
}

/// Gray bits down to 2 projector pixels, with fringes of 4 pixels.
const Shot& fine_ball(double blur_px) {
    static std::map<double, Shot> shots;
    const auto found = shots.find(blur_px);
    if (found != shots.end()) return found->second;
    Room room = paper_room(sphere(kCentre, kRadius_mm));
    room.light.projector_blur_px = blur_px;
    StripeSettings stripes = stripes_of(room);
    stripes.phase_period_px = 4;
    stripes.phase_steps = 3;
    return shots.emplace(blur_px, shot_of(std::move(room), stripes)).first->second;
}

/// Without the fringes and the `bits_less` finest bits of either direction.
ScanCapture gray_only(const ScanCapture& whole, int bits_less = 0) {
    ScanCapture gray;
    gray.stripes = whole.stripes;
    const auto sequence = stripe_sequence(whole.stripes);
    for (std::size_t i = 0; i < sequence.size(); ++i) {
        const auto kind = sequence[i].kind;
        const bool bit = kind == StripePattern::Kind::gray_bit || kind == StripePattern::Kind::gray_bit_inverse;
        if (kind == StripePattern::Kind::phase) continue;
        if (bit && sequence[i].index >= gray_bits(whole.stripes, sequence[i].along_rows) - bits_less) continue;
        gray.partial.push_back(sequence[i]);
        gray.left.push_back(whole.left[i]);
        gray.right.push_back(whole.right[i]);
    }
    return gray;
}

struct Off {
    double mean = 0, rms = 0, p99 = 0;
};

Off off_the_sphere(const PointCloud& cloud) {
    Off off;
    std::vector<double> sizes;
    for (const auto& p : cloud.points_in_rig) {
        const double e = (p - kCentre).norm() - kRadius_mm;
        off.mean += e / static_cast<double>(cloud.size());
        off.rms += e * e / static_cast<double>(cloud.size());
        sizes.push_back(std::abs(e));
    }
    off.rms = std::sqrt(off.rms);
    fmt::print("off the true sphere: mean {:.3f}, rms {:.3f} mm\n", off.mean, off.rms);
    std::sort(sizes.begin(), sizes.end());
    if (!sizes.empty()) off.p99 = sizes[sizes.size() * 99 / 100];
    return off;
}

TEST(FewerDevices, OneCameraAndTheProjectorPlaceTheBall) {
    RigCalibration rig = ball().rig;
    rig.right_camera = {};
    const ScanResult scan = scan_from_capture(ball().capture, rig);
    EXPECT_GT(scan.clean.kept.size(), 20000u);
    EXPECT_EQ(scan.raw.three_view, 0u);
    EXPECT_FALSE(scan.resection) << "nothing says where the projector stands";
    // 0.02 px of code over 13 degrees of angle at 0.44 mm a pixel: 0.04 mm; edges are kept away from.
    const Off off = off_the_sphere(scan.clean.kept);
    EXPECT_LT(std::abs(off.mean), 0.02);
    EXPECT_LT(off.rms, 0.04);
    ScanCapture left_only = ball().capture;
    left_only.right.clear();
    EXPECT_EQ(scan_from_capture(left_only, ball().rig).clean.kept.size(), scan.clean.kept.size())
        << "it is the same whether the rig or the capture lacks the right camera";
}

// Planes of light: 0.02 px of code, as above, and nothing that averages over two directions.
TEST(FewerDevices, OneCameraAndPlanesOfLightPlaceTheBall) {
    ScanCapture columns = ball().capture;
    columns.stripes.rows = false;
    columns.right.clear();
    columns.left.resize(stripe_sequence(columns.stripes).size());
    const ScanResult scan = scan_from_capture(columns, ball().rig);
    EXPECT_GT(scan.clean.kept.size(), 20000u);
    EXPECT_EQ(scan.raw.three_view, 0u);
    const Off off = off_the_sphere(scan.clean.kept);
    EXPECT_LT(std::abs(off.mean), 0.03);
    EXPECT_LT(off.rms, 0.06);
    // A rig whose projector stands elsewhere by half its picture: the light would come from beside it, and that is
    // seen.
    RigCalibration wrong = ball().rig;
    wrong.projector.centre_y += 500;
    EXPECT_LT(scan_from_capture(columns, wrong).raw.cloud.size(), scan.raw.cloud.size() / 2);
}

/// A device of 20 degrees at `eye` that looks at `target`.
Optics small_device(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, int width, int height, double focal) {
    Optics o;
    const Eigen::Vector3d z = (target - eye).normalized(), x = Eigen::Vector3d::UnitY().cross(z).normalized();
    o.R << x.transpose(), z.cross(x).transpose(), z.transpose();
    o.t = -o.R * eye;
    o.width = width;
    o.height = height;
    o.fx = o.fy = focal;
    o.cx = 0.5 * (width - 1);
    o.cy = 0.5 * (height - 1);
    o.distortion[0] = -0.1;
    return o;
}

/// A tilted plane before a projector and two cameras beside it.
Room near_room(double away_mm, double baseline_mm) {
    const Eigen::Vector3d target(0, 0, away_mm);
    Room room;
    room.projector = small_device({0, 0, 0}, target, 800, 600, 1400);
    room.left = small_device({-baseline_mm, 5, 10}, target, 320, 240, 700);
    room.right = small_device({baseline_mm, 0, -5}, target, 320, 240, 700);
    room.surface = plane(target, Eigen::Vector3d(0.1, 0.2, -1).normalized());
    room.light.white_grey = 190 * away_mm * away_mm / 810000;  // as bright everywhere as at 900 mm
    return room;
}

/// The working volume begins at 200 mm before the projector. Errors grow with the distance squared by the baseline:
/// 0.05 px of code are 0.05 mm at 250 mm over 60 mm, 0.6 mm at 900 mm.
TEST(FewerDevices, ColumnsPlaceWhatIsNearAndWhatIsFar) {
    for (const double away_mm : {250.0, 300.0, 350.0, 900.0})
        for (const double baseline_mm : {60.0, 150.0, 250.0}) {
            const Room room = near_room(away_mm, baseline_mm);
            const StripeSettings stripes = fast_stripes(800, 600);
            const ScanCapture both = capture(room, stripes);
            const Truth truth = truth_of(room, room.left);
            const auto lit = static_cast<double>(
                std::count_if(truth.code.begin(), truth.code.end(), [](const auto& c) { return !std::isnan(c.x()); }));
            for (const int cameras : {1, 2}) {
                ScanCapture seen = both;
                if (cameras == 1) seen.right.clear();
                const ScanResult scan = scan_from_capture(seen, rig_of(room));
                std::vector<double> off;
                for (const auto& p : scan.raw.cloud.points_in_rig)
                    off.push_back(
                        std::abs(Eigen::Vector3d(0.1, 0.2, -1).normalized().dot(p - Eigen::Vector3d(0, 0, away_mm))));
                const std::string where =
                    fmt::format("{} mm away, baseline {} mm, {} cameras", away_mm, baseline_mm, cameras);
                EXPECT_GT(static_cast<double>(off.size()) * scan.raw.stride.x * scan.raw.stride.y,
                          (cameras == 1 ? 0.8 : 0.4) * lit)
                    << where;
                if (off.empty()) continue;
                std::nth_element(off.begin(), off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2), off.end());
                EXPECT_LT(off[off.size() / 2], 0.05 + 0.05 * away_mm * away_mm / (baseline_mm * 1400)) << where;
            }
        }
}

TEST(FewerDevices, TwoCamerasDoWithoutKnowingTheProjector) {
    RigCalibration rig = ball().rig;
    rig.projector = {};
    const ScanResult scan = scan_from_capture(ball().capture, rig);
    EXPECT_GT(scan.clean.kept.size(), 15000u);
    const Off off = off_the_sphere(scan.clean.kept);
    EXPECT_LT(std::abs(off.mean), 0.02);
    EXPECT_LT(off.rms, 0.08);
    EXPECT_LT(scan.raw.epipolar_rms_px, 0.2);
    for (std::size_t i = 0; i < scan.clean.kept.size(); i += 100)
        EXPECT_GT(scan.clean.kept.normals_in_rig[i].dot(scan.clean.kept.points_in_rig[i] - kCentre), 0)
            << "towards the cameras";
}

TEST(FewerDevices, TwoCamerasAndColumnsOnlyMeetOnTheEpipolarLine) {
    RigCalibration rig = ball().rig;
    rig.projector = {};
    ScanCapture columns = ball().capture;
    columns.stripes.rows = false;
    const std::size_t n = stripe_sequence(columns.stripes).size();
    columns.left.resize(n);
    columns.right.resize(n);
    const ScanResult scan = scan_from_capture(columns, rig);
    EXPECT_GT(scan.clean.kept.size(), 15000u);
    const Off off = off_the_sphere(scan.clean.kept);
    EXPECT_LT(std::abs(off.mean), 0.02);
    EXPECT_LT(off.rms, 0.15);
}

/// The same camera on its side or upside down: its picture turned by quarters.
Optics rolled(const Optics& camera, int quarters) {
    Optics o = camera;
    o.distortion[2] = o.distortion[3] = 0;
    for (int k = 0; k < quarters; ++k) {
        const Eigen::Matrix3d turn = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
        o.R = (turn * o.R).eval();
        o.t = (turn * o.t).eval();
        std::swap(o.width, o.height);
        std::swap(o.fx, o.fy);
        o.cx = o.cy = 0;
    }
    o.cx = 0.5 * (o.width - 1);
    o.cy = 0.5 * (o.height - 1);
    return o;
}

/// Which way up a camera hangs is a number in rig.json and nothing else: of all devices, of columns alone, and of two
/// cameras without the projector.
TEST(FewerDevices, CamerasOnTheirSidesAndUpsideDownScanAsWell) {
    for (const auto& [left_quarters, right_quarters] : {std::pair(1, 1), {2, 0}, {1, 3}}) {
        Room room = paper_room(sphere(kCentre, kRadius_mm));
        room.left = rolled(room.left, left_quarters);
        room.right = rolled(room.right, right_quarters);
        const StripeSettings stripes = stripes_of(room);
        const Shot shot = shot_of(std::move(room), stripes);
        const std::string where = fmt::format("left {}, right {} quarters", left_quarters, right_quarters);
        const ScanResult scan = scan_from_capture(shot.capture, shot.rig);
        EXPECT_EQ(scan.rig.verdict, RigState::Verdict::as_calibrated) << where << ": " << scan.rig.sentence;
        EXPECT_GT(scan.clean.kept.size(), 20000u) << where;
        EXPECT_LT(off_the_sphere(scan.clean.kept).rms, 0.04) << where;
        ScanCapture columns = shot.capture;
        columns.stripes.rows = false;
        const std::size_t n = stripe_sequence(columns.stripes).size();
        columns.left.resize(n);
        columns.right.resize(n);
        for (const bool projector : {true, false}) {
            RigCalibration rig = shot.rig;
            if (!projector) rig.projector = {};
            const ScanResult by_columns = scan_from_capture(columns, rig);
            EXPECT_GT(by_columns.clean.kept.size(), 15000u) << where << (projector ? "" : ", no projector");
            EXPECT_LT(off_the_sphere(by_columns.clean.kept).rms, 0.15) << where << (projector ? "" : ", no projector");
        }
    }
}

/// Three shifts of 64 pixels under a gamma of 2.2: a twentieth of a period is 3 projector pixels, 4 mm along one
/// camera's line of sight. Noise at the fringes' crests is what is left; nothing is said to have moved.
TEST(FewerDevices, ThreeShiftsUnderAGammaPlaceTheBall) {
    Room room = paper_room(sphere(kCentre, kRadius_mm));
    StripeSettings stripes = stripes_of(room);
    stripes.phase_steps = 3;
    stripes.phase_period_px = 64;
    const Shot shot = shot_of(std::move(room), stripes);
    const ScanResult both = scan_from_capture(shot.capture, shot.rig);
    EXPECT_FALSE(both.rig.moved()) << both.rig.sentence;
    EXPECT_GT(both.clean.kept.size(), 15000u);
    const Off by_both = off_the_sphere(both.clean.kept);
    EXPECT_LT(std::abs(by_both.mean), 0.05);
    EXPECT_LT(by_both.rms, 0.15);
    ScanCapture left = shot.capture;
    left.right.clear();
    const ScanResult one = scan_from_capture(left, shot.rig);
    EXPECT_GT(one.clean.kept.size(), 10000u);
    const Off by_one = off_the_sphere(one.clean.kept);
    EXPECT_LT(std::abs(by_one.mean), 0.1);
    EXPECT_LT(by_one.rms, 0.5);
}

TEST(FewerDevices, OneCameraWithoutAProjectorIsRefused) {
    RigCalibration rig = ball().rig;
    rig.projector = rig.right_camera = {};
    EXPECT_THROW(scan_from_capture(ball().capture, rig), std::invalid_argument);
}

TEST(GrayOnly, IsReadToItsFinestCellAndSaysSo) {
    const Shot& shot = fine_ball(0.6);
    double last_rms = 0;
    for (const int less : {0, 1, 2}) {
        const ScanResult scan = scan_from_capture(gray_only(shot.capture, less), shot.rig);
        const double step = 2 << less;
        EXPECT_EQ(scan.code_step_px, step);
        EXPECT_GT(scan.clean.kept.size(), 10000u) << less;
        const Off off = off_the_sphere(scan.clean.kept);
        // A cell is 0.42 mm a pixel wide; both cameras see its borders alike, so little of it goes into depth.
        EXPECT_LT(off.rms, 0.05 * step) << less;
        EXPECT_LT(std::abs(off.mean), 0.045 * step) << "the ball is flattened over three cells";
        EXPECT_GT(off.rms, last_rms) << "coarser with every bit less";
        last_rms = off.rms;
    }
}

TEST(GrayOnly, TheCodeIsRightToItsCell) {
    const Shot& shot = fine_ball(0.6);
    const ScanResult scan = scan_from_capture(gray_only(shot.capture, 1), shot.rig);
    const Truth truth = truth_of(shot.room, shot.room.left);
    std::size_t decoded = 0, wrong = 0;
    double squares = 0;
    for (std::size_t i = 0; i < truth.code.size(); ++i) {
        if (std::isnan(scan.left.column[i]) || std::isnan(truth.code[i].x())) continue;
        ++decoded;
        const double off = scan.left.column[i] - truth.code[i].x();
        wrong += std::abs(off) > 4;  // a cell
        squares += off * off;
    }
    EXPECT_GT(decoded, 50000u);
    EXPECT_LT(static_cast<double>(wrong), 1e-4 * static_cast<double>(decoded));
    const double rms = std::sqrt(squares / static_cast<double>(decoded));
    EXPECT_LT(rms, 0.3 * 0.29 * 4) << "smoothed, it is better than the bare cell by far";
}

TEST(GrayOnly, BitsTooFineForTheOpticsAreLeftOut) {
    const ScanResult scan = scan_from_capture(gray_only(fine_ball(3).capture), fine_ball(3).rig);
    EXPECT_GE(scan.code_step_px, 4);
    EXPECT_LE(scan.code_step_px, 16);
    EXPECT_GT(scan.clean.kept.size(), 5000u);
    EXPECT_LT(off_the_sphere(scan.clean.kept).rms, 0.05 * scan.code_step_px);
}

TEST(GrayOnly, FringesTooFineForTheOpticsFallBackToTheGrayCode) {
    const ScanResult fine = scan_from_capture(fine_ball(0.6).capture, fine_ball(0.6).rig);
    EXPECT_EQ(fine.code_step_px, 0) << "these are resolved";
    const ScanResult coarse = scan_from_capture(fine_ball(3).capture, fine_ball(3).rig);
    EXPECT_GE(coarse.code_step_px, 4);
    EXPECT_GT(coarse.clean.kept.size(), 5000u);
}

TEST(GrayOnly, OneCameraToo) {
    RigCalibration rig = fine_ball(0.6).rig;
    rig.right_camera = {};
    const ScanResult scan = scan_from_capture(gray_only(fine_ball(0.6).capture), rig);
    EXPECT_EQ(scan.code_step_px, 2);
    EXPECT_GT(scan.clean.kept.size(), 10000u);
    EXPECT_LT(off_the_sphere(scan.clean.kept).rms, 0.12);
}

}  // namespace
}  // namespace planlight
