#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "registration/matching/register_patient.h"
#include "tests/registration/matching/matching_scenes.h"
#include "tests/registration/matching/trial_scan.h"
#include "tests/support/analytic_head.h"

// What nobody plans for: found where it is, or not taken for sure.
namespace planlight::test {
namespace {

using Eigen::Vector3d;

const TrialSurface& head() {
    static const TrialSurface surface(analytic_head_mesh(1.5));
    return surface;
}

/// A face, half from the side, as a rig sees it.
TrialScan face(unsigned seed, double scale = 1, double width_mm = 220) {
    TrialScanSettings settings;
    settings.from_in_ct = Vector3d(seed % 2 ? 0.5 : -0.4, -1, 0.2).normalized();
    settings.roll = 1.7 * seed;
    settings.width_mm = width_mm;
    settings.scale = scale;
    settings.seed = seed;
    return trial_scan(head(), settings);
}

/// `more` beside `scan` in one picture: its head stands `beside_mm` to the left of the other's.
void put_beside(const TrialScan& more, double beside_mm, TrialScan& scan) {
    const RigidTransform there(Eigen::Translation3d(beside_mm, 0, 0));
    const RigidTransform rig_from_rig = scan.rig_from_ct * there * more.rig_from_ct.inverse();
    const PointCloud cloud = moved(more.cloud, rig_from_rig);
    scan.cloud.points_in_rig.insert(scan.cloud.points_in_rig.end(), cloud.points_in_rig.begin(),
                                    cloud.points_in_rig.end());
    scan.cloud.normals_in_rig.insert(scan.cloud.normals_in_rig.end(), cloud.normals_in_rig.begin(),
                                     cloud.normals_in_rig.end());
}

TEST(StrangeScene, ASecondHeadOfAnotherSizeInThePictureIsNotTakenForThePatient) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
        TrialScan scan = face(seed);
        put_beside(face(seed + 20, seed % 2 ? 0.85 : 1.15), seed % 3 ? 260 : -280, scan);
        const RegistrationResult found = register_patient(scan.cloud, head_lut());
        EXPECT_NE(found.verdict, Verdict::no) << "seed " << seed << ": the patient is there";
        if (found.verdict == Verdict::no) continue;
        EXPECT_LT(pose_error(found.patient_from_ct, scan).target_mm, 2) << "seed " << seed;
    }
}

TEST(StrangeScene, TwinsInOnePictureAreNotAYes) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
        TrialScan scan = face(seed);
        put_beside(face(seed), 260, scan);
        EXPECT_NE(register_patient(scan.cloud, head_lut()).verdict, Verdict::yes) << "seed " << seed;
    }
}

TEST(StrangeScene, TheSameHeadOfAnotherSizeIsNotAYes) {
    for (const double scale : {0.7, 0.8, 0.9, 0.94, 1.06, 1.1, 1.2, 1.4}) {
        const RegistrationResult found = register_patient(face(5, scale).cloud, head_lut());
        EXPECT_NE(found.verdict, Verdict::yes) << scale;
    }
}

TEST(StrangeScene, HalfAFaceIsFoundOrNotSure) {
    // The right half alone, as where a wall hides the left one.
    for (unsigned seed = 1; seed <= 4; ++seed) {
        TrialScan scan = face(seed);
        const RigidTransform ct_from_rig = scan.rig_from_ct.inverse();
        PointCloud half;
        for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
            if ((ct_from_rig * scan.cloud.points_in_rig[i]).x() > head().middle_in_ct().x()) continue;
            half.points_in_rig.push_back(scan.cloud.points_in_rig[i]);
            half.normals_in_rig.push_back(scan.cloud.normals_in_rig[i]);
        }
        const RegistrationResult found = register_patient(half, head_lut());
        const double off_mm = pose_error(found.patient_from_ct, scan).target_mm;
        EXPECT_TRUE(found.verdict == Verdict::no || off_mm < 3) << "seed " << seed << ": " << off_mm << " mm off";
    }
}

}  // namespace
}  // namespace planlight::test
