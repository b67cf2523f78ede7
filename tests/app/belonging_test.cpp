#include "app/belonging.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "app/case_model.h"
#include "planning_io/case/rig_file.h"
#include "planning_io/types/error.h"
#include "tests/planning_io/example_rig.h"

namespace planlight {
namespace {

Case a_case() {
    Case made;
    made.code = "c0ffee";
    made.volume_hash = "0123456789";
    made.lut.mesh_hash = "9876543210";
    made.plan.boreholes.emplace_back().position_in_ct = {0, 0, 700};
    return made;
}

RigState a_state(RigState::Verdict verdict) {
    RigState state;
    state.verdict = verdict;
    state.sentence = "the projector moved";
    state.remedy = "Calibrate the rig again.";
    state.rig = test::example_rig();
    state.calibrated = name_of(state.rig);
    state.capture_hash = "a capture";
    return state;
}

RegistrationResult match_with(const std::optional<RigState>& rig) {
    RegistrationResult match;
    match.verdict = Verdict::yes;
    match.covariance.of_turn_and_shift.setIdentity();
    match.covariance.of_turn_and_shift *= 1e-8;
    match.covariance.centre_in_ct = {0, 0, 700};
    take_case_and_rig(a_case(), rig, match);
    return match;
}

/// The left camera turned by so much sideways against what is used.
RigDoubt turned(double radians) {
    RigDoubt doubt;
    for (auto& by : doubt.by) by.setZero();
    doubt.by[0][1] = radians;
    return doubt;
}

TEST(RigOfAMatch, DecidesWhetherItMayBeUsed) {
    using V = RigState::Verdict;
    EXPECT_EQ(match_with(a_state(V::as_calibrated)).verdict, Verdict::yes);
    EXPECT_EQ(match_with(a_state(V::corrected)).verdict, Verdict::yes);
    EXPECT_EQ(match_with(a_state(V::unknown)).verdict, Verdict::ask);
    const RegistrationResult refused = match_with(a_state(V::not_trusted));
    EXPECT_EQ(refused.verdict, Verdict::no);
    EXPECT_NE(refused.reasons.front().find("the projector moved"), std::string::npos);
    EXPECT_EQ(refused.reasons.at(1), a_state(V::not_trusted).remedy) << "what is to be done about it";
    EXPECT_EQ(match_with(std::nullopt).verdict, Verdict::yes) << "the cloud of another scanner";
}

TEST(RigOfAMatch, AsksWhereTheScanIsOfAPatientWhoMoved) {
    RigState state = a_state(RigState::Verdict::as_calibrated);
    state.accepted_movement_mm = 0.8;
    const RegistrationResult match = match_with(state);
    EXPECT_EQ(match.verdict, Verdict::ask);
    ASSERT_EQ(match.reasons.size(), 1u);
    EXPECT_NE(match.reasons[0].find("moved by 0.8 mm during the scan"), std::string::npos);
}

/// Pictures that are read with another period than they were made with look like a zoom, all of one scan.
TEST(RigOfAMatch, AsksWhereTheProjectorSeemsToHaveZoomed) {
    RigState state = a_state(RigState::Verdict::corrected);
    double& zoomed = state.devices[static_cast<std::size_t>(RigDevice::projector)].focal_change;
    for (const double change : {-0.0604, -0.006, 0.006, 0.0604}) {
        zoomed = change;
        const RegistrationResult match = match_with(state);
        EXPECT_EQ(match.verdict, Verdict::ask);
        ASSERT_FALSE(match.reasons.empty());
        EXPECT_NE(match.reasons.back().find("capture.json"), std::string::npos) << match.reasons.back();
    }
    zoomed = 0.002;
    EXPECT_EQ(match_with(state).verdict, Verdict::yes) << "a focus that was touched";
}

/// Seen from 700 mm by the projector of the rig: 2 mm are four of its pixels and more.
TEST(Belonging, PointsThatDoNotLieWhereTheirRigSawThemAreRefused) {
    const RigState state = a_state(RigState::Verdict::as_calibrated);
    PointCloud cloud;
    for (int i = 0; i < 400; ++i) {
        cloud.points_in_rig.emplace_back(5 * (i % 20) - 50, 5 * (i / 20) - 50, 700 + i % 7);
        const auto pixel = project(state.rig.projector, cloud.points_in_rig.back());
        ASSERT_TRUE(pixel);
        cloud.pixels_in_projector.push_back(*pixel);
    }
    EXPECT_NO_THROW(check_points(cloud, state, "c"));
    PointCloud part = cloud;
    part.points_in_rig.resize(100);
    part.pixels_in_projector.resize(100);
    EXPECT_NO_THROW(check_points(part, state, "c")) << "deleted points are no harm";
    const auto with = [&](const auto& change) {
        PointCloud changed = cloud;
        for (std::size_t i = 0; i < changed.points_in_rig.size(); ++i) change(changed.points_in_rig[i], i);
        return changed;
    };
    using Eigen::Vector3d;
    EXPECT_THROW(check_points(with([](Vector3d& p, std::size_t) { p.x() += 20; }), state, "c"), DamagedFileError);
    EXPECT_THROW(check_points(with([](Vector3d& p, std::size_t) { p.y() += 20; }), state, "c"), DamagedFileError);
    EXPECT_THROW(check_points(with([](Vector3d& p, std::size_t) { p *= 0.001; }), state, "c"), DamagedFileError);
    EXPECT_THROW(check_points(with([](Vector3d& p, std::size_t) { p.x() = -p.x(); }), state, "c"), DamagedFileError);
    EXPECT_THROW(check_points(with([](Vector3d& p, std::size_t i) { p.x() += i % 10 == 0 ? 40 : 0; }), state, "c"),
                 DamagedFileError)
        << "a tenth of them";
    PointCloud bare = cloud;
    bare.pixels_in_projector.clear();
    EXPECT_THROW(check_points(bare, state, "c"), DamagedFileError);
    EXPECT_NO_THROW(check_points(bare, std::nullopt, "c")) << "of another scanner";
    EXPECT_NO_THROW(check_points(bare, a_state(RigState::Verdict::unknown), "c")) << "asked about anyway";
}

/// A camera turned by 0.2 degrees moves a point 700 mm away and seen from 300 mm apart by 5 mm in depth.
TEST(RigOfAMatch, AsksWhereAPlanPointMayBeOffAndSaysItInTheBound) {
    RigState state = a_state(RigState::Verdict::corrected);
    state.doubts = {turned(0.0035)};
    const RegistrationResult match = match_with(state);
    EXPECT_EQ(match.verdict, Verdict::ask);
    EXPECT_GT(predicted_light_mm(match, {0, 0, 700}), 1);
    state.doubts = {turned(0.0001)};
    EXPECT_EQ(match_with(state).verdict, Verdict::yes);
    EXPECT_LT(predicted_light_mm(match_with(state), {0, 0, 700}), 0.5);
}

/// A board whose squares are 0.7 % too large makes everything so, the light as well: at 100 mm from the middle of the
/// scan by 0.7 mm. What is within two sigmas may be nothing.
TEST(RigOfAMatch, AScanOfAnotherSizeIsInTheBound) {
    RegistrationResult match = match_with(a_state(RigState::Verdict::as_calibrated));
    match.covariance.of_turn_and_shift.setIdentity();
    match.covariance.of_turn_and_shift *= 1e-8;
    match.covariance.centre_in_ct = {10, 0, 0};
    const Eigen::Vector3d far(110, 0, 0);
    match.scale_sigma = 0.001;
    match.scale = 1.0015;
    EXPECT_LT(predicted_light_mm(match, far), 0.05);
    for (const double scale : {0.991, 1.009}) {
        match.scale = scale;
        EXPECT_NEAR(predicted_light_mm(match, far), 0.7, 0.05);
        EXPECT_LT(predicted_light_mm(match, match.covariance.centre_in_ct), 0.05);
    }
}

/// The plan's hole as it is drawn: a stroke of two points on the skin.
PlanDrawing drawn_hole() {
    PlanDrawing drawing;
    drawing.items.emplace_back().name = "B1";
    Stroke stroke{};
    stroke.kind = StrokeKind::borehole;
    stroke.item = 0;
    stroke.points_in_ct = {{0, 0, 700}, {4, 0, 700}};
    drawing.strokes.push_back(stroke);
    return drawing;
}

TEST(ItemsOfAMatch, OneThatTheScanSawCoveredIsAskedAboutByName) {
    RegistrationResult match = match_with(a_state(RigState::Verdict::as_calibrated));
    match.skin.apart_mm = 4;
    match.skin.places = {{{20, 0, 700}, 0, 0.1}};
    match.skin.covered = {{{1, 0, 700}, 7}, {{60, 0, 700}, 9}};
    judge_items(drawn_hole(), match);
    EXPECT_EQ(match.verdict, Verdict::ask);
    ASSERT_EQ(match.reasons.size(), 1U);
    EXPECT_NE(match.reasons[0].find("B1: over 100 % of it the scan saw a surface up to 7 mm outside"),
              std::string::npos)
        << match.reasons[0];
    EXPECT_TRUE(std::isinf(predicted_errors_mm(a_case().plan, match).at(0)));

    RegistrationResult elsewhere = match_with(a_state(RigState::Verdict::as_calibrated));
    elsewhere.skin.apart_mm = 4;
    elsewhere.skin.covered = {{{60, 0, 700}, 9}};
    judge_items(drawn_hole(), elsewhere);
    EXPECT_EQ(elsewhere.verdict, Verdict::yes);
}

TEST(ItemsOfAMatch, OneThatMayLieFarOffIsAskedAbout) {
    for (const auto& [sigma_mm, verdict] : {std::pair(0.3, Verdict::yes), {0.8, Verdict::ask}}) {
        RegistrationResult match = match_with(a_state(RigState::Verdict::as_calibrated));
        match.covariance.of_turn_and_shift.diagonal().tail<3>().setConstant(sigma_mm * sigma_mm);
        judge_items(drawn_hole(), match);
        EXPECT_EQ(match.verdict, verdict) << predicted_light_mm(match, {0, 0, 700});
    }
}

TEST(ItemsOfAMatch, WhereItMayBeAnotherPoseNoBoundIsGiven) {
    RegistrationResult match = match_with(a_state(RigState::Verdict::as_calibrated));
    match.mirror_ratio = 1.03;
    EXPECT_TRUE(std::isfinite(predicted_light_mm(match, {0, 0, 700}))) << "landmarks made it a yes";
    match.verdict = Verdict::ask;
    EXPECT_TRUE(std::isinf(predicted_light_mm(match, {0, 0, 700})));
    match.mirror_ratio = 1.5;
    EXPECT_TRUE(std::isfinite(predicted_light_mm(match, {0, 0, 700})));
}

/// Not within 0.0 mm, which nothing could be.
TEST(RigOfAMatch, APoseOfWhichNothingIsKnownMayBeOffByAnything) {
    RegistrationResult match = match_with(a_state(RigState::Verdict::as_calibrated));
    match.covariance.of_turn_and_shift.setZero();
    EXPECT_TRUE(std::isinf(predicted_light_mm(match, {0, 0, 700})));
    match.covariance.of_turn_and_shift.diagonal().setConstant(std::numeric_limits<double>::infinity());
    EXPECT_TRUE(std::isinf(predicted_light_mm(match, {0, 0, 700})));
    for (const double mm : predicted_errors_mm(a_case().plan, match)) EXPECT_TRUE(std::isinf(mm));
    TriangleMesh skin;
    skin.vertices_in_ct = {{0, 0, 700}};
    EXPECT_TRUE(std::isinf(predicted_on_skin_mm(skin, match)->at(0)));
}

TEST(RigOfAMatch, LightIsDrawnWithTheRigThatWasFoundOrNotAtAll) {
    RigState state = a_state(RigState::Verdict::corrected);
    state.rig.projector.centre_x += 5;
    const RigCalibration calibrated = test::example_rig();
    EXPECT_EQ(rig_of_light(match_with(state), calibrated, false).projector.centre_x, calibrated.projector.centre_x + 5);
    state.verdict = RigState::Verdict::not_trusted;
    EXPECT_THROW(rig_of_light(match_with(state), calibrated, true), CheckFailedError) << "also on a person's word";
    EXPECT_THROW(rig_of_light(match_with(std::nullopt), calibrated, false), CheckFailedError);
    EXPECT_NO_THROW(rig_of_light(match_with(std::nullopt), calibrated, true));
}

TEST(Belonging, AnotherRigCaseOrScanIsRefusedAndWhatIsNotSaidIsSaid) {
    const RegistrationResult match = match_with(a_state(RigState::Verdict::corrected));
    std::vector<std::string> unknown;
    EXPECT_NO_THROW(check_case(match, a_case(), "m", unknown));
    EXPECT_NO_THROW(check_rig(match, test::example_rig(), "m", "r", unknown));
    EXPECT_TRUE(unknown.empty());
    Case other = a_case();
    other.volume_hash = "another";
    EXPECT_THROW(check_case(match, other, "m", unknown), InputError);
    other = a_case();
    other.code = "another plan";
    EXPECT_THROW(check_case(match, other, "m", unknown), InputError) << "it was judged at the points of that one";
    RigCalibration moved = test::example_rig();
    moved.left_camera.focal_x += 1e-9;
    EXPECT_THROW(check_rig(match, moved, "m", "r", unknown), InputError);
    PosesOrigin poses{match.rig->calibrated, "a capture", match.rig->rig};
    const auto poses_are_checked = [&](const std::optional<PosesOrigin>& origin, bool confirmed) {
        check_poses(origin, match, test::example_rig(), "p", confirmed, unknown);
    };
    EXPECT_NO_THROW(poses_are_checked(poses, false));
    EXPECT_TRUE(unknown.empty());
    poses.rig.left_camera = changed(poses.rig.left_camera, DeviceChange::Unit(1) * 1e-3);
    EXPECT_THROW(poses_are_checked(poses, true), InputError);
    poses = {match.rig->calibrated, "another capture", match.rig->rig};
    EXPECT_THROW(poses_are_checked(poses, true), InputError);
    poses.capture_hash.clear();  // they begin at their first frame
    EXPECT_THROW(poses_are_checked(poses, false), CheckFailedError);
    EXPECT_THROW(poses_are_checked(std::nullopt, false), CheckFailedError);
    EXPECT_TRUE(unknown.empty());
    poses_are_checked(poses, true);
    poses_are_checked(std::nullopt, true);
    check_rig(RegistrationResult{}, test::example_rig(), "m", "r", unknown);
    check_case(RegistrationResult{}, a_case(), "m", unknown);
    EXPECT_EQ(unknown.size(), 4u);
}

}  // namespace
}  // namespace planlight
