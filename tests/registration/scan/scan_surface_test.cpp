#include "registration/scan/scan_surface.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "tests/registration/scan/stripe_room.h"

namespace planlight {
namespace {

using namespace stripe_room;

const Eigen::Vector3d kCentre(120, -40, 360), kPlace(120, -40, 300);
const Eigen::Vector3d kTilted = Eigen::Vector3d(0.35, 0.2, -1).normalized();
const Eigen::Vector3d kTowards = Eigen::Vector3d(0.1, 0.35, -1).normalized();  // the devices, seen from the object

struct Scanned {
    Room room;
    RigCalibration rig;
    ScanCapture shot;
    ScanResult result;
};

Scanned scan(Room room) {
    Scanned s{std::move(room), {}, {}, {}};
    s.rig = rig_of(s.room);
    s.shot = capture(s.room, stripes_of(s.room));
    s.result = scan_from_capture(s.shot, s.rig);
    return s;
}

const Scanned& on_sphere() {
    static const Scanned s = scan(paper_room(sphere(kCentre, 80)));
    return s;
}
const Scanned& on_plane() {
    static const Scanned s = scan(paper_room(plane(kPlace, kTilted)));
    return s;
}

/// Centre and radius of the sphere through points, least squares (algebraic, linear).
Eigen::Vector4d fit_sphere(const std::vector<Eigen::Vector3d>& points) {
    Eigen::MatrixX4d A(static_cast<Eigen::Index>(points.size()), 4);
    Eigen::VectorXd b(A.rows());
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
        const Eigen::Vector3d p = points[static_cast<std::size_t>(i)] - kCentre;
        A.row(i) << 2 * p.transpose(), 1;
        b(i) = p.squaredNorm();
    }
    const Eigen::Vector4d x = (A.transpose() * A).ldlt().solve(A.transpose() * b);
    return {x(0), x(1), x(2), std::sqrt(x(3) + x.head<3>().squaredNorm())};
}

TEST(ScanSurface, SphereHasItsRadiusAndPlace) {
    const auto& kept = on_sphere().result.clean.kept;
    ASSERT_GT(kept.size(), 20000u);
    EXPECT_LE(kept.size(), 40000u);
    const Eigen::Vector4d found = fit_sphere(kept.points_in_rig);
    EXPECT_NEAR(found(3), 80, 0.05);
    EXPECT_LT(found.head<3>().norm(), 0.05);
    double squares = 0;
    for (const auto& p : kept.points_in_rig) squares += std::pow((p - kCentre).norm() - 80, 2);
    EXPECT_LT(std::sqrt(squares / static_cast<double>(kept.size())), 0.05);
}

TEST(ScanSurface, NormalsPointOutOfTheSphere) {
    const auto& kept = on_sphere().result.clean.kept;
    ASSERT_EQ(kept.normals_in_rig.size(), kept.size());
    double squares = 0;
    for (std::size_t i = 0; i < kept.size(); ++i) {
        const double cosine = kept.normals_in_rig[i].dot((kept.points_in_rig[i] - kCentre).normalized());
        ASSERT_GT(cosine, 0.5);
        squares += std::pow(std::acos(std::min(1.0, cosine)), 2);
    }
    EXPECT_LT(std::sqrt(squares / static_cast<double>(kept.size())), 0.06);  // 3.4 degrees over patches of about 2 mm
}

TEST(ScanSurface, PlaneIsFlatAndWhereItIs) {
    const auto& cloud = on_plane().result.raw.cloud;
    ASSERT_GT(cloud.size(), 50000u);
    double sum = 0, squares = 0;
    std::size_t far = 0;
    for (const auto& p : cloud.points_in_rig) {
        const double off = kTilted.dot(p - kPlace);
        sum += off;
        squares += off * off;
        far += std::abs(off) > 0.5 ? 1u : 0u;
    }
    const auto n = static_cast<double>(cloud.size());
    EXPECT_LT(std::abs(sum / n), 0.02);
    EXPECT_LT(std::sqrt(squares / n), 0.05);
    EXPECT_LT(static_cast<double>(far), 1e-4 * n);
}

TEST(ScanSurface, CovarianceIsHonestWhenTheRigIsExact) {
    // With a perfect calibration only the noise of the code is left; then sigma must predict the error of the points
    // along the worst direction (depth). Its square over many points is a chi-square of mean 1.
    TriangulationSettings settings;
    settings.camera_sigma_px = 1e-3;
    settings.projector_sigma_px = 1e-3;
    settings.max_residual_sigma = 6;
    settings.stride = 3;
    const Triangulation raw = triangulate(on_plane().result.left, on_plane().result.right, on_plane().rig, settings);
    ASSERT_GT(raw.three_view, 10000u);
    double chi2 = 0, n = 0;
    for (std::size_t i = 0; i < raw.cloud.size(); ++i) {
        if (raw.seen[i] != Triangulation::Seen::both) continue;
        const double off = kTilted.dot(raw.cloud.points_in_rig[i] - kPlace) / (kTilted.dot(-kTowards));
        chi2 += std::pow(off / raw.cloud.sigma_mm[i], 2);
        n += 1;
    }
    EXPECT_GT(chi2 / n, 0.5);
    EXPECT_LT(chi2 / n, 2.0);
}

TEST(ScanSurface, ResultsDoNotDependOnTheThreads) {
    const ScanResult again = scan_from_capture(on_sphere().shot, on_sphere().rig);
    ASSERT_EQ(again.clean.kept.size(), on_sphere().result.clean.kept.size());
    for (std::size_t i = 0; i < again.clean.kept.size(); i += 97)
        EXPECT_EQ(again.clean.kept.points_in_rig[i], on_sphere().result.clean.kept.points_in_rig[i]);
}

TEST(ScanSurface, ColumnsAloneSufficeWhereThreeViewsMeet) {
    DecodedView left = on_sphere().result.left, right = on_sphere().result.right;
    left.row.clear();
    right.row.clear();
    const Triangulation raw = triangulate(left, right, on_sphere().rig);
    ASSERT_GT(raw.three_view, 30000u);
    EXPECT_EQ(raw.two_view, 0u);
    double squares = 0;
    std::size_t far = 0;
    for (const auto& p : raw.cloud.points_in_rig) {
        const double off = (p - kCentre).norm() - 80;
        squares += off * off;
        far += std::abs(off) > 1 ? 1u : 0u;
    }
    EXPECT_LT(std::sqrt(squares / static_cast<double>(raw.cloud.size())), 0.15);
    EXPECT_LT(far, 20u);
}

TEST(ScanSurface, TheFastSetFindsTheSphere) {
    const Room& room = on_sphere().room;
    const ScanResult result =
        scan_from_capture(capture(room, fast_stripes(room.projector.width, room.projector.height)), rig_of(room));
    ASSERT_GT(result.clean.kept.size(), 20000u);
    const Eigen::Vector4d found = fit_sphere(result.clean.kept.points_in_rig);
    EXPECT_NEAR(found(3), 80, 0.05);
    EXPECT_LT(found.head<3>().norm(), 0.05);
    double squares = 0;
    for (const auto& p : result.clean.kept.points_in_rig) squares += std::pow((p - kCentre).norm() - 80, 2);
    EXPECT_LT(std::sqrt(squares / static_cast<double>(result.clean.kept.size())), 0.1);
}

TEST(ScanSurface, AnEmptyRoomGivesAnEmptyCloudAndSaysWhy) {
    const Room room = paper_room(sphere(Eigen::Vector3d(5000, 0, 0), 10));
    const ScanResult result = scan_from_capture(capture(room, stripes_of(room)), rig_of(room));
    EXPECT_TRUE(result.clean.kept.empty());
    EXPECT_EQ(result.left.dark, result.left.column.size());
}

TEST(ScanSurface, OneCameraBlockedLeavesTwoViewPoints) {
    DecodedView blind = on_sphere().result.right;
    std::fill(blind.column.begin(), blind.column.end(), NAN);
    std::fill(blind.row.begin(), blind.row.end(), NAN);
    const Triangulation raw = triangulate(on_sphere().result.left, blind, on_sphere().rig);
    EXPECT_EQ(raw.three_view, 0u);
    EXPECT_GT(raw.two_view, 30000u);
    for (std::size_t i = 0; i < raw.cloud.size(); i += 11) {
        const double off = (raw.cloud.points_in_rig[i] - kCentre).norm() - 80;
        ASSERT_LT(std::abs(off), 5 * raw.cloud.sigma_mm[i]);
    }
    TriangulationSettings both_only;
    both_only.one_camera = false;
    const Triangulation none = triangulate(on_sphere().result.left, blind, on_sphere().rig, both_only);
    EXPECT_TRUE(none.cloud.empty());
    EXPECT_GT(none.no_partner, 30000u);
}

// Mutations of the rig: each must be seen, by the gate or by the evidence, and the sound rig must not be.
bool looks_sound(const Triangulation& t) {
    const double points = static_cast<double>(t.three_view),
                 all = points + static_cast<double>(t.disagree + t.outside_volume);
    return points > 0.97 * all && t.epipolar_rms_px < 0.15 && t.projector_offset_px.norm() < 0.2;
}
Triangulation with(const RigCalibration& rig) {
    return triangulate(on_sphere().result.left, on_sphere().result.right, rig);
}

TEST(ThreeViewGate, ASoundRigIsSound) {
    EXPECT_TRUE(looks_sound(on_sphere().result.raw));
}

TEST(ThreeViewGate, HalfAPixelInOneCameraShows) {
    for (int axis = 0; axis < 2; ++axis) {
        RigCalibration rig = on_sphere().rig;
        (axis == 0 ? rig.left_camera.centre_x : rig.left_camera.centre_y) += 0.5;
        EXPECT_FALSE(looks_sound(with(rig))) << axis;
    }
}

TEST(ThreeViewGate, HalfAPixelInTheProjectorShowsAndIsTolerated) {
    RigCalibration rig = on_sphere().rig;
    rig.projector.centre_x += 0.5;
    rig.projector.centre_y += 0.5;
    const Triangulation raw = with(rig);
    EXPECT_FALSE(looks_sound(raw));
    EXPECT_NEAR(raw.projector_offset_px.x(), -0.5, 0.03);
    EXPECT_NEAR(raw.projector_offset_px.y(), -0.5, 0.03);
    // The cameras place the points all the same.
    EXPECT_GT(static_cast<double>(raw.three_view), 0.95 * static_cast<double>(on_sphere().result.raw.three_view));
    double sum = 0, n = 0;
    for (std::size_t i = 0; i < raw.cloud.size(); ++i) {
        if (raw.seen[i] != Triangulation::Seen::both) continue;
        sum += (raw.cloud.points_in_rig[i] - kCentre).norm() - 80;
        n += 1;
    }
    EXPECT_LT(std::abs(sum / n), 0.03);
}

TEST(ThreeViewGate, SwappedRowsAndColumnsShow) {
    Scanned s = on_sphere();
    std::swap(s.result.left.column, s.result.left.row);
    std::swap(s.result.right.column, s.result.right.row);
    EXPECT_FALSE(looks_sound(triangulate(s.result.left, s.result.right, s.rig)));
}

TEST(ThreeViewGate, AFlippedDistortionOrATransposedRotationShows) {
    RigCalibration rig =
        on_plane().rig;  // it fills the picture: distortion grows with the cube of the distance from its centre
    EXPECT_TRUE(looks_sound(triangulate(on_plane().result.left, on_plane().result.right, rig)));
    rig.right_camera.k1 = -rig.right_camera.k1;
    EXPECT_FALSE(looks_sound(triangulate(on_plane().result.left, on_plane().result.right, rig)));
    rig = on_sphere().rig;
    rig.right_camera.device_from_rig.linear().transposeInPlace();
    EXPECT_FALSE(looks_sound(with(rig)));
    rig = on_sphere().rig;
    std::swap(rig.left_camera, rig.right_camera);
    EXPECT_FALSE(looks_sound(with(rig)));
}

TEST(ThreeViewGate, AWrongCodeIsDropped) {
    // A period off in one view: a match elsewhere, or none; never a point far from the sphere.
    Scanned s = on_sphere();
    for (std::size_t i = 0; i < s.result.right.column.size(); ++i)
        if ((i / 40) % 2 == 0) s.result.right.column[i] += 16;
    TriangulationSettings both_only;
    both_only.one_camera = false;
    const Triangulation raw = triangulate(s.result.left, s.result.right, s.rig, both_only);
    std::size_t far = 0;
    for (const auto& p : raw.cloud.points_in_rig) far += std::abs((p - kCentre).norm() - 80) > 1 ? 1u : 0u;
    EXPECT_LE(far, raw.cloud.size() / 10000);
    EXPECT_GT(raw.disagree + raw.no_partner, 10000u);
}

TEST(RemoveOutliers, AFloatingScrapIsRemovedAndTheHeadStays) {
    const Eigen::Vector3d above = kCentre + 130 * kTowards;
    const Scanned s = scan(paper_room(nearest_of({sphere(kCentre, 80), plane(above, -kTowards, 3.5)})));
    const auto at_scrap = [&](const Eigen::Vector3d& p) { return (p - kCentre).norm() > 110; };
    const auto& raw = s.result.raw.cloud.points_in_rig;
    const auto& kept = s.result.clean.kept.points_in_rig;
    EXPECT_GT(std::count_if(raw.begin(), raw.end(), at_scrap), 50);
    EXPECT_EQ(std::count_if(kept.begin(), kept.end(), at_scrap), 0);
    EXPECT_GT(s.result.clean.small_piece, 50u);
    EXPECT_GT(kept.size(), 20000u);
    std::size_t far = 0;
    for (const auto& p : kept) far += std::abs((p - kCentre).norm() - 80) > 1 ? 1u : 0u;
    EXPECT_LE(far, kept.size() / 2000);  // the rims of the shadow
}

TEST(RemoveOutliers, CountsAddUpAndThinningIsEven) {
    const auto& clean = on_sphere().result.clean;
    EXPECT_EQ(clean.kept.size() + clean.jump + clean.grazing + clean.small_piece + clean.lonely + clean.thinned,
              on_sphere().result.raw.cloud.size());
    OutlierSettings few;
    few.max_points = 2000;
    const OutlierReport thin = remove_outliers(on_sphere().result.raw, on_sphere().rig, few);
    EXPECT_LE(thin.kept.size(), 2000u);
    EXPECT_GT(thin.kept.size(), 1800u);
    // Even: halves of the sphere towards the devices hold the share of points that they hold of all.
    const auto share = [](const std::vector<Eigen::Vector3d>& points) {
        double n = 0;
        for (const auto& p : points) n += (p - kCentre).normalized().dot(kTowards) > 0.75 ? 1 : 0;
        return n / static_cast<double>(points.size());
    };
    // The caps of a sphere have areas as their heights: 0.25 of (1 - cos 75 degrees = 0.74), where the pixels of a
    // camera would have 0.47. The points of a cube grid are as dense as its cubes cut the surface: up to 1.7 times more
    // obliquely.
    EXPECT_NEAR(share(thin.kept.points_in_rig), 0.25 / 0.74, 0.08);
}

TEST(RemoveOutliers, SteepPointsAreRemoved) {
    OutlierSettings settings;
    settings.max_grazing_angle = 0.8;
    const OutlierReport report = remove_outliers(on_sphere().result.raw, on_sphere().rig, settings);
    const Eigen::Vector3d lamp = on_sphere().room.projector.eye();
    for (const auto& p : report.kept.points_in_rig)
        ASSERT_LT(std::acos((p - kCentre).normalized().dot((lamp - p).normalized())), 0.8 + 0.15);
    EXPECT_GT(report.grazing, 10000u);
}

TEST(RemoveOutliers, NothingInNothingOut) {
    EXPECT_TRUE(remove_outliers({}, on_sphere().rig).kept.empty());
}

TEST(ScanSurface, AForeignCaptureIsRefused) {
    ScanCapture shot = on_sphere().shot;
    shot.right.pop_back();
    EXPECT_THROW(scan_from_capture(shot, on_sphere().rig), std::invalid_argument);
    RigCalibration rig = on_sphere().rig;
    rig.projector.width = 1024;
    EXPECT_THROW(scan_from_capture(on_sphere().shot, rig), std::invalid_argument);
    rig = on_sphere().rig;
    rig.left_camera.width = 640;
    EXPECT_THROW(scan_from_capture(on_sphere().shot, rig), std::invalid_argument);
}

}  // namespace
}  // namespace planlight
