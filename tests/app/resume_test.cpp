// A session goes on with the match of one that was cut short when all is as it was; else it stays dark and says why.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>

#include "app/compare_skin.h"
#include "app/kept_match.h"
#include "app/session.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"
#include "planning_io/types/triangle_mesh.h"
#include "registration/matching/measure_displacement.h"
#include "registration/simulation/simulated_rig.h"
#include "tests/app/played_session.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using simulation::SimulatedRig;

/// One room, scanned and matched by a session that is over; what it kept went through a file.
class Resume : public ::testing::Test {
protected:
    struct World {
        CaseDrawing drawing{test::example_case().prepared};
        std::unique_ptr<SimulatedRig> rig;
        std::string kept;
    };
    static World made(unsigned seed) {
        World w;
        const Case& the_case = test::example_case().prepared;
        simulation::RoomSettings room;
        room.preset = simulation::Preset::paper;
        room.seed = seed;
        w.rig = std::make_unique<SimulatedRig>(test::example_case().volume, points_of(the_case.plan), room);
        w.rig->set_motion({0.0, w.rig->clock().now()});
        Session session(the_case, w.drawing, w.rig->calibration(), w.rig->projector(), w.rig->cameras(),
                        w.rig->clock());
        session.scan();
        session.find_patient();
        session.confirm();
        w.kept = text_of(*session.kept_match());
        return w;
    }
    static const World& world() {
        static const World one = made(11);
        return one;
    }
    void SetUp() override {
        if (!test::example_case().there) GTEST_SKIP() << "the package invesalius-examples is not installed";
    }
    static SimulatedRig& rig() { return *world().rig; }
    static KeptMatch kept() { return kept_match_of(world().kept, "a recording"); }
    static Session session(const Case& the_case = test::example_case().prepared) {
        return {the_case, world().drawing, rig().calibration(), rig().projector(), rig().cameras(), rig().clock()};
    }
    /// The plan's points by what the session believes against where they truly are, mm.
    static double off_mm(const Session& session, const Session::Update& update) {
        const RigidTransform found = *update.pose.rig_from_patient * session.registration()->patient_from_ct;
        const RigidTransform truth = rig().true_rig_from_ct(update.frame.at);
        double worst = 0;
        for (const Vector3d& p : points_of(session.plan())) worst = std::max(worst, (found * p - truth * p).norm());
        return worst;
    }
    static void expect_gone_on_with() {
        Session again = session();
        again.resume(kept());
        ASSERT_NE(again.registration(), nullptr);
        const auto update = again.update();
        EXPECT_TRUE(update.overlay.lit) << update.overlay.reason;
        // The match of the example patient is within a millimetre (app/ACCURACY.md), its pose within some tenths.
        EXPECT_LT(off_mm(again, update), 1.2);
    }
    /// Refused with these words, no match, and after the stripes nothing but darkness.
    static void expect_dark(Session& again, const KeptMatch& match, const std::string& words) {
        try {
            again.resume(match);
            ADD_FAILURE() << "it was gone on with; expected: " << words;
        } catch (const CheckFailedError& refusal) {
            EXPECT_NE(std::string(refusal.what()).find(words), std::string::npos) << refusal.what();
        }
        EXPECT_EQ(again.registration(), nullptr);
        EXPECT_THROW(again.update(), CheckFailedError);
    }
    static void expect_refused(const std::string& words) {
        Session again = session();
        expect_dark(again, kept(), words);
    }
};

TEST_F(Resume, NothingMoved) {
    expect_gone_on_with();
}

TEST_F(Resume, TheHeadMovedWithItsMarkers) {
    rig().set_motion({20, rig().clock().now()});
    rig().wait(std::chrono::seconds(3));
    rig().set_motion({0, rig().clock().now()});
    expect_gone_on_with();
}

TEST_F(Resume, WhatWasKeptReadsBackBitForBit) {
    EXPECT_EQ(text_of(kept()), world().kept);
}

TEST_F(Resume, AHeadThatMovedAgainstItsMarkersIsRefused) {
    // A head that slid, or turned, under a stiff cap: only the skin can tell. In every direction, for a head is no
    // sphere.
    for (const Vector3d& way : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1)}) {
        for (const double mm : {3.0, 15.0}) {
            KeptMatch match = kept();
            for (PatientMarker& marker : match.markers) marker.centre_in_patient += mm * way;
            Session again = session();
            expect_dark(again, match, "where ");
        }
    }
}

/// A slipped sticker does not slip back to its place: a room of its own for each.
TEST_F(Resume, StickersThatWereMovedAreRefused) {
    for (const auto& [marker, slide] : {std::pair(0, Vector3d(1.5, 0, 1.5)), std::pair(-1, Vector3d(2.5, 0, 2.5))}) {
        const World own = made(12);
        own.rig->slip_marker(marker, slide);
        Session again(test::example_case().prepared, own.drawing, own.rig->calibration(), own.rig->projector(),
                      own.rig->cameras(), own.rig->clock());
        expect_dark(again, kept_match_of(own.kept, "a recording"), "marker");
    }
}

TEST_F(Resume, ARigThatWasBumpedIsRefused) {
    const double half_a_degree = 0.5 * std::numbers::pi / 180;
    for (const auto device :
         {SimulatedRig::Device::left_camera, SimulatedRig::Device::right_camera, SimulatedRig::Device::projector}) {
        rig().bump(device, half_a_degree * Vector3d(0, 1, 0));
        expect_refused("the last match is not used");
        rig().bump(device, -half_a_degree * Vector3d(0, 1, 0));
    }
    expect_gone_on_with();
}

TEST_F(Resume, MarkersThatAreCoveredAreRefusedAndTriedAgain) {
    rig().cover_markers({0, 1, 2, 3, 4, 5, 6, 7});
    Session again = session();
    expect_dark(again, kept(), "markers");
    rig().cover_markers({});
    again.resume(kept());
    EXPECT_TRUE(again.update().overlay.lit);
}

TEST_F(Resume, AnotherCasePlanOrRigIsRefused) {
    KeptMatch match = kept();
    match.registration.of_case.mesh_hash = "another";
    Session again = session();
    expect_dark(again, match, "it is of the case");
    match = kept();
    match.plan_hash = "another";
    expect_dark(again, match, "plan");
    match = kept();
    match.registration.rig->calibrated.hash = "another";
    expect_dark(again, match, "another rig");
    match = kept();
    match.registration.verdict = Verdict::no;
    expect_dark(again, match, "no match");
}

TEST_F(Resume, AMatchThatNobodyLookedAtStaysUnlit) {
    KeptMatch match = kept();
    match.registration.verdict = Verdict::ask;
    match.confirmed = false;
    Session again = session();
    again.resume(match);
    EXPECT_FALSE(again.update().overlay.lit);
    again.confirm();
    EXPECT_TRUE(again.update().overlay.lit);
}

/// What a short scan of the face sees of the table's skin, with noise, where the head lies.
PointCloud face_of(const SkinLut& lut) {
    std::mt19937 random(7);
    std::normal_distribution<double> noise_mm(0, 0.3);
    PointCloud cloud;
    const std::size_t step = 1 + lut.skin.size() / 60000;
    for (std::size_t i = 0; i < lut.skin.size(); i += step) {
        const Vector3d normal = lut.skin[i].normal_in_ct.cast<double>();
        if (lut.skin[i].flags != kSkin || normal.y() > -0.35) continue;
        cloud.points_in_rig.push_back(lut.skin[i].position_in_ct.cast<double>() + noise_mm(random) * normal);
        cloud.normals_in_rig.push_back(normal);
    }
    return cloud;
}

// Matched on bare skin, draped afterwards: the drapes are no skin that lies elsewhere.
TEST_F(Resume, DrapesThatWereLaidOnTheSkinDoNotMakeItLieElsewhere) {
    const Case& the_case = test::example_case().prepared;
    const PointCloud bare = face_of(the_case.lut);
    RegistrationResult match;
    match.skin = measure_displacement(bare, the_case.lut, RigidTransform::Identity());
    match.residual_median_mm = 0.2;
    PointCloud draped = bare;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> cloth_mm(2, 8);
    std::vector<double> heights;
    for (const Vector3d& p : bare.points_in_rig) heights.push_back(p.z());
    std::sort(heights.begin(), heights.end());
    const double edge = heights[heights.size() * 65 / 100];
    for (std::size_t i = 0; i < draped.size(); ++i)  // all but a window
        if (draped.points_in_rig[i].z() < edge) draped.points_in_rig[i] += cloth_mm(random) * draped.normals_in_rig[i];
    const auto checked = [&](const PointCloud& cloud, const Vector3d& slide_mm) {
        RigidTransform rig_from_ct = RigidTransform::Identity();
        rig_from_ct.translation() = slide_mm;
        SkinCheck check;
        compare_skin(cloud, the_case, match, rig_from_ct, ResumeSettings{}.max_more_residual_mm, check);
        return check;
    };
    const SkinCheck where_it_was = checked(draped, Vector3d::Zero());
    EXPECT_GT(where_it_was.residual_mm, 2) << "most of what is scanned is cloth";
    EXPECT_FALSE(where_it_was.elsewhere) << where_it_was.why_not << ", " << where_it_was.residual_mm;
    const SkinCheck moved = checked(draped, {0, 12, 0});
    EXPECT_FALSE(moved.known && moved.off_mm < 2) << "a head that moved under them is not said to be in its place";
}

// From 20 mm off the fit finds some place near by, with a bound of several millimetres: that was "within 0.9 mm".
TEST_F(Resume, ACheckOfTheSkinNeverSaysOfAFarHeadThatItIsNear) {
    const Case& the_case = test::example_case().prepared;
    const PointCloud cloud = face_of(the_case.lut);
    ASSERT_GT(cloud.size(), 5000U);
    RegistrationResult match;
    match.skin = measure_displacement(cloud, the_case.lut, RigidTransform::Identity());
    match.residual_median_mm = 0.2;
    ASSERT_TRUE(match.skin.known());
    const auto checked = [&](const Vector3d& slide_mm) {
        RigidTransform rig_from_ct = RigidTransform::Identity();
        rig_from_ct.translation() = slide_mm;
        SkinCheck check;
        compare_skin(cloud, the_case, match, rig_from_ct, ResumeSettings{}.max_more_residual_mm, check);
        return check;
    };
    int elsewhere = 0;
    for (const Vector3d& way : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1), Vector3d(0.6, -0.8, 0)}) {
        for (const double mm : {4.0, 8.0, 13.0, 20.0, 26.0, 33.0}) {
            const SkinCheck check = checked(mm * way);
            elsewhere += check.elsewhere;
            EXPECT_TRUE(check.elsewhere || (check.known && check.off_mm > 2))
                << mm << " mm along " << way.transpose() << ": within " << check.off_mm << " of " << check.bound_mm;
            if (check.elsewhere) {
                EXPECT_FALSE(check.known);
                EXPECT_EQ(check.off_mm, 0) << "it is not known";
            }
        }
        const SkinCheck near = checked(0.5 * way);
        EXPECT_TRUE(near.known) << near.why_not;
        EXPECT_NEAR(near.off_mm, 0.5, 0.4);
    }
    EXPECT_GT(elsewhere, 0) << "else this test tells nothing";
}

}  // namespace
}  // namespace planlight
