#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "app/evaluation/chain_report.h"
#include "app/evaluation/run_chain.h"
#include "app/prepare_case.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

/// The example patient, prepared once.
class WholeChain : public ::testing::Test {
protected:
    static void SetUpTestSuite() {
        if (!test::example_patient()) return;
        volume_ = read_volume(*test::example_patient());
        prepared_ =
            prepare_case(*volume_, read_plan(std::string(PLANLIGHT_EXAMPLE_FOLDER) + "/frontal_defect.mrk.json"), {},
                         {}, "2001-10-14")
                .prepared;
    }
    void SetUp() override {
        if (!volume_) GTEST_SKIP() << "the package invesalius-examples is not installed";
    }
    static ChainFigures run(const Case& the_case, const ChainSettings& settings) {
        return run_chain(*volume_, the_case, CaseDrawing(the_case), settings);
    }
    static ChainSettings short_run(unsigned seed) {
        ChainSettings settings;
        settings.preset = simulation::Preset::paper;
        settings.seed = seed;
        settings.rest_updates = 4;
        settings.moving_updates = 8;
        settings.measured_updates = 3;
        return settings;
    }
    static simulation::RoomSettings papers_room(unsigned seed) {
        simulation::RoomSettings settings;
        settings.preset = simulation::Preset::paper;
        settings.seed = seed;
        return settings;
    }
    /// What the demo promises of every room.
    static bool good(const ChainFigures& f) {
        return f.refused.empty() && f.initial_match_right && distribution_of(f.tre_mm).p95 <= 1 &&
               f.at_rest.position_mm.size() > 20 && distribution_of(f.at_rest.position_mm).p95 <= 1 &&
               distribution_of(f.moving.position_mm).p95 <= 2;
    }
    static std::optional<Volume> volume_;
    static Case prepared_;
};
std::optional<Volume> WholeChain::volume_;
Case WholeChain::prepared_;

TEST_F(WholeChain, PutsThePlanOnTheSkinInThePapersRoom) {
    const ChainFigures figures = run(prepared_, short_run(1));
    EXPECT_EQ(figures.refused, "");
    EXPECT_TRUE(good(figures)) << "TRE " << distribution_of(figures.tre_mm).p95 << ", at rest "
                               << distribution_of(figures.at_rest.position_mm).p95 << ", moving "
                               << distribution_of(figures.moving.position_mm).p95;
    EXPECT_EQ(figures.lost_marker_lit, figures.lost_marker_updates) << "a lost marker is survived";
    EXPECT_EQ(figures.too_few_lit, 0) << "too few markers give no light";
}

TEST_F(WholeChain, APatientWhoMovesDuringTheScanIsScannedAgain) {
    simulation::SimulatedRig room(*volume_, {}, papers_room(1));
    room.set_motion({1, room.clock().now()});
    room.wait(std::chrono::seconds(1));
    const CaseDrawing drawing(prepared_);
    Session session(prepared_, drawing, room.calibration(), room.projector(), room.cameras(), room.clock());
    bool moving = true;
    session.scan([&](int done, int of) {
        if (moving && done == of)
            room.set_motion({0, room.clock().now()}), moving = false;  // after the first scan's last picture
    });
    EXPECT_EQ(session.scans_repeated(), 1);
    EXPECT_LE(session.motion_in_scan_mm(), 0.15);
    EXPECT_GT(session.scanned()->clean.kept.size(), 10000u);

    SessionSettings once;
    once.max_scans = 1;
    Session hurried(prepared_, drawing, room.calibration(), room.projector(), room.cameras(), room.clock(), once);
    room.set_motion({1, room.clock().now()});
    EXPECT_THROW(hurried.scan(), CheckFailedError);
}

/// In this room the cheek turns away from the light along a column of the projector's picture, as that picture's end
/// would look.
TEST_F(WholeChain, WhereTheHeadTurnsAwayFromTheLightTheProjectorsPictureDoesNotEnd) {
    simulation::SimulatedRig room(*volume_, points_of(prepared_.plan), papers_room(529));
    const CaseDrawing drawing(prepared_);
    Session session(prepared_, drawing, room.calibration(), room.projector(), room.cameras(), room.clock());
    EXPECT_NO_THROW(session.scan());
}

TEST_F(WholeChain, ADoubtfulMatchIsDrawnOnThePersonsWordAndTheWordHoldsForThatMatchOnly) {
    simulation::SimulatedRig room(*volume_, {}, papers_room(1));
    const CaseDrawing drawing(prepared_);
    SessionSettings doubting;
    doubting.registration.min_agreeing_bases = 1000;  // every match is an `ask`
    Session session(prepared_, drawing, room.calibration(), room.projector(), room.cameras(), room.clock(), doubting);
    const auto lit = [&] {
        bool any = false;
        for (int i = 0; i < 4; ++i) any |= session.update().overlay.lit;
        return any;
    };
    session.scan();
    ASSERT_EQ(session.find_patient().verdict, Verdict::ask);
    EXPECT_FALSE(lit()) << "nobody has looked yet";
    session.confirm();
    EXPECT_TRUE(lit());
    session.go_dark();
    EXPECT_TRUE(lit()) << "after DARK the word still holds";
    ASSERT_EQ(session.find_patient().verdict, Verdict::ask);
    EXPECT_FALSE(lit()) << "that word was given for another match";
}

/// The brightest number of a picture, and what CHECK last measured.
struct LightOfSession {
    int brightest = 0, looks = 0, dark = 0;
    LightCheck last{};
};

LightOfSession light_of(Session& session, int updates) {
    LightOfSession result;
    for (int i = 0; i < updates; ++i) {
        const Session::Update update = session.update();
        result.dark += update.overlay.lit ? 0 : 1;
        result.brightest = 0;
        for (const Rgb& c : update.overlay.picture.pixels)
            result.brightest = std::max({result.brightest, static_cast<int>(c[0]), static_cast<int>(c[1])});
        if (!update.light) continue;
        ++result.looks;
        result.last = *update.light;
    }
    return result;
}

TEST_F(WholeChain, InADarkRoomTheLightIsDimmedAndMeasuredAsWell) {
    simulation::SimulatedRig room(*volume_, {}, papers_room(1));
    const CaseDrawing drawing(prepared_);
    Session session(prepared_, drawing, room.calibration(), room.projector(), room.cameras(), room.clock());
    session.scan();
    ASSERT_EQ(session.find_patient().verdict, Verdict::yes);
    const LightOfSession usual = light_of(session, 60);
    room.set_lamps(0.02, 7);  // a tenth of the lamps, and cameras that see the markers all the same
    const LightOfSession at_first = light_of(session, 4), dark = light_of(session, 120);
    EXPECT_EQ(usual.dark + at_first.dark + dark.dark, 0);
    EXPECT_EQ(usual.brightest, 255) << "under the usual lamps all of the light";
    EXPECT_GT(at_first.brightest, 0.9 * usual.brightest) << "step by step";
    EXPECT_LT(dark.brightest, 0.9 * usual.brightest)
        << "lines " << at_first.last.brighter << " times as bright again as skin of " << at_first.last.background;
    EXPECT_GT(dark.last.brighter, 2) << "and stands out all the same";
    EXPECT_GT(dark.last.seen_share(), at_first.last.seen_share() - 0.05);
    EXPECT_LT(dark.last.median_mm, usual.last.median_mm + 0.1);
    room.set_lamps(0.2);
    EXPECT_EQ(light_of(session, 120).brightest, usual.brightest) << "when the lamps go on again";
}

TEST_F(WholeChain, LandmarksOnTheScanCheckTheMatch) {
    simulation::SimulatedRig room(*volume_, {}, papers_room(2));
    const CaseDrawing drawing(prepared_);
    Session session(prepared_, drawing, room.calibration(), room.projector(), room.cameras(), room.clock());
    const RigidTransform truth = room.true_rig_from_ct(room.clock().now());
    const PointCloud& scanned = session.scan().clean.kept;
    std::vector<PointPair> landmarks;  // places of the scan, and where they truly lie in ct
    for (const double share : {0.05, 0.3, 0.6, 0.95}) {
        const Eigen::Vector3d p_in_rig =
            scanned.points_in_rig[static_cast<std::size_t>(share * static_cast<double>(scanned.size()))];
        landmarks.push_back({"landmark " + std::to_string(landmarks.size() + 1), truth.inverse() * p_in_rig, p_in_rig});
    }
    EXPECT_EQ(session.find_patient(landmarks).verdict, Verdict::yes);
    landmarks[2].in_ct += Eigen::Vector3d(0, 0, 6);
    const RegistrationResult doubtful = session.find_patient(landmarks);
    EXPECT_EQ(doubtful.verdict, Verdict::ask);
    EXPECT_NE(doubtful.reasons.back().find("\"landmark 3\" lies"), std::string::npos) << doubtful.reasons.back();
    EXPECT_FALSE(session.update().overlay.lit) << "a landmark is off: nobody has looked yet";
    landmarks[2].in_ct += Eigen::Vector3d(0, 0, 10);
    EXPECT_EQ(session.find_patient(landmarks).verdict, Verdict::no);
    EXPECT_FALSE(session.update().overlay.lit);
}

TEST_F(WholeChain, AMirroredPatientIsNeverProjectedOn) {
    Case mirrored = prepared_;
    Volume volume = *volume_;  // left and right exchanged, as a reader that forgets the rows' direction would give
    for (int k = 0; k < volume.size[2]; ++k)
        for (int j = 0; j < volume.size[1]; ++j)
            std::reverse(volume.values.begin() + static_cast<std::ptrdiff_t>(volume.index(0, j, k)),
                         volume.values.begin() + static_cast<std::ptrdiff_t>(volume.index(0, j, k)) + volume.size[0]);
    mirrored = prepare_case(volume, prepared_.plan, {}, {}, "2001-10-14").prepared;
    const ChainFigures figures = run(mirrored, short_run(1));
    EXPECT_FALSE(good(figures));
    EXPECT_NE(figures.registration ? figures.registration->verdict : Verdict::no, Verdict::yes)
        << "residual " << figures.registration->residual_rms_mm;
}

/// The calibration that the product is given is spoiled on purpose; the chain must not come out good.
class SpoiledCalibration : public WholeChain {
protected:
    static bool good_with(const std::function<void(RigCalibration&)>& spoil) {
        ChainSettings settings = short_run(1);
        settings.spoil_calibration = spoil;
        return good(run(prepared_, settings));
    }
};

// The room's lenses are mild and the head is in the middle of the pictures: with the sign of the distortion flipped the
// light still lands within a millimetre. The scan's own evidence must show it all the same, though pose and offset of
// the skin take up most of it: the residual rises by a fifth.
TEST_F(SpoiledCalibration, FlippedDistortionShowsInTheScan) {
    ChainSettings settings = short_run(1);
    settings.rest_updates = settings.moving_updates = 1;
    const ChainFigures right = run(prepared_, settings);
    settings.spoil_calibration = [](RigCalibration& rig) {
        for (auto* device : {&rig.left_camera, &rig.right_camera, &rig.projector}) {
            device->k1 = -device->k1;
            device->k2 = -device->k2;
        }
    };
    const ChainFigures flipped = run(prepared_, settings);
    EXPECT_GT(distribution_of(flipped.scan_error_mm).median, 2 * distribution_of(right.scan_error_mm).median);
    EXPECT_GT(flipped.registration->residual_rms_mm, 1.1 * right.registration->residual_rms_mm)
        << "flipped " << flipped.registration->residual_rms_mm << " mm, right " << right.registration->residual_rms_mm
        << " mm";
}

TEST_F(SpoiledCalibration, TransposedRotationIsNotGood) {
    EXPECT_FALSE(good_with([](RigCalibration& rig) {
        for (auto* device : {&rig.left_camera, &rig.right_camera, &rig.projector})
            device->device_from_rig.linear() = device->device_from_rig.linear().transpose().eval();
    }));
}

TEST_F(SpoiledCalibration, SwappedCamerasAreNotGood) {
    EXPECT_FALSE(good_with([](RigCalibration& rig) { std::swap(rig.left_camera, rig.right_camera); }));
}

}  // namespace
}  // namespace planlight
