#include "app/verify_landmarks.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "projection/render_drawing.h"
#include "projection/stroke_places.h"
#include "tests/support/analytic_head.h"

namespace planlight {
namespace {

/// As large as a head, with its corners where a head has crown, chin, nose, nape and ears.
SkinSurface octahedron() {
    TriangleMesh mesh;
    mesh.vertices_in_ct = {{90, 0, 0}, {-90, 0, 0}, {0, 90, 0}, {0, -90, 0}, {0, 0, 90}, {0, 0, -90}};
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    return SkinSurface(mesh);
}

TEST(VerifyLandmarks, WordsSayWhereOnTheHeadAPlaceIs) {
    const SkinSurface head = octahedron();
    EXPECT_EQ(words_of_place(head, {0, -90, 0}), "at the front of the head") << "LPS: y grows to the back";
    EXPECT_EQ(words_of_place(head, {60, -60, -20}), "at the front of the head, on the patient's left");
    EXPECT_EQ(words_of_place(head, {-52, -52, 52}),
              "at the front of the head, on the patient's right, towards the crown");
    EXPECT_EQ(words_of_place(head, {0, 63, -63}), "at the back of the head, towards the neck");
}

/// A plate that faces the front, with a smaller one that hides it from there.
SkinSurface plate_behind_another() {
    TriangleMesh mesh;
    mesh.vertices_in_ct = {{-80, 0, -80},   {80, 0, -80},   {80, 0, 80},   {-80, 0, 80},
                           {-30, -60, -30}, {30, -60, -30}, {30, -60, 30}, {-30, -60, 30}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
    return SkinSurface(mesh);
}

TEST(VerifyLandmarks, APlaceIsLookedAtFromWhereNothingIsBeforeIt) {
    const SkinSurface plates = plate_behind_another();
    for (const Eigen::Vector3d& place :
         {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(20, 0, 0), Eigen::Vector3d(-10, 0, 15), Eigen::Vector3d(0, 0, -20),
          Eigen::Vector3d(0, -60, 0)}) {
        const Eigen::Vector3d from = free_view_of(plates, place);
        EXPECT_NEAR(from.norm(), 1, 1e-9);
        EXPECT_LT(from.y(), 0) << "the front of the plate, " << place.transpose();
        EXPECT_LT(std::abs(from.z()), 0.8) << "the head is seen upright";
        const auto hit = plates.first_hit({place + 500 * from, -from});
        ASSERT_TRUE(hit);
        EXPECT_LT((hit->p_in_ct - place).norm(), 1) << place.transpose();
    }
    EXPECT_NEAR(free_view_of(plates, {60, 0, 0}).y(), -1, 1e-6) << "what is free is seen straight";
    EXPECT_GT(free_view_of(plates, {20, 0, 0}).x(), 0) << "from the side that it is nearer to";
}

/// As a room has them: projector and cameras a metre before the origin of rig, which the cameras see from both sides.
RigCalibration rig_before_the_head() {
    const auto device = [](double x_mm) {
        CameraModel model;
        model.width = 1280, model.height = 1024;
        model.focal_x = model.focal_y = 2400;
        model.centre_x = 639.5, model.centre_y = 511.5;
        const Eigen::Vector3d centre(x_mm, 0, -1000), forward = -centre.normalized(),
                                                      right = Eigen::Vector3d::UnitY().cross(forward).normalized();
        Eigen::Matrix3d rows;
        rows << right.transpose(), forward.cross(right).transpose(), forward.transpose();
        model.device_from_rig.linear() = rows;
        model.device_from_rig.translation() = -rows * centre;
        return model;
    };
    RigCalibration rig;
    rig.left_camera = device(-200), rig.right_camera = device(200), rig.projector = device(0);
    return rig;
}

/// How much of the ring that is lit on a landmark reaches the skin, or is seen by this camera, at up to 60 degrees.
double share_of_ring(const SkinSurface& skin, const CameraModel& device, const RigidTransform& rig_from_ct,
                     const Eigen::Vector3d& landmark) {
    Plan plan;
    Borehole ring;
    ring.name = "Landmark";
    ring.position_in_ct = landmark;
    ring.diameter_mm = kLandmarkRing_mm;
    plan.boreholes.push_back(ring);
    constexpr double kSteepest = 1.05;
    DrawingSettings drawing;
    drawing.labels = false;
    double lit_mm = 0, all_mm = 0;
    for (const Stroke& stroke : draw_plan(plan, skin, drawing).strokes)
        for (std::size_t i = 1; i < stroke.points_in_ct.size(); ++i) {
            const double length_mm = (stroke.points_in_ct[i] - stroke.points_in_ct[i - 1]).norm();
            StrokePlace place;
            place.p_in_ct = stroke.points_in_ct[i];
            place.normal_in_ct = stroke.normals_in_ct[i];
            all_mm += length_mm;
            if (freely_seen(place, skin, device, rig_from_ct, kSteepest)) lit_mm += length_mm;
        }
    return lit_mm / all_mm;
}

// From wherever the light comes, and flat enough for the cameras to measure it: not on the rim of an ear.
TEST(VerifyLandmarks, TheRingOnEachCanBeLitAndSeen) {
    const SkinSurface head(test::analytic_head_mesh(4));
    const RigCalibration rig = rig_before_the_head();
    for (int k = 0; k < 8; ++k) {
        RigidTransform rig_from_ct = RigidTransform::Identity();  // the face towards the devices, the crown up
        rig_from_ct.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
        rig_from_ct.rotate(Eigen::AngleAxisd(k * M_PI / 4, Eigen::Vector3d::UnitZ()));
        const auto landmarks = landmarks_to_verify(head, rig, rig_from_ct);
        EXPECT_EQ(landmarks.size(), 2U);
        for (const Eigen::Vector3d& landmark : landmarks)
            for (const CameraModel& device : {rig.projector, rig.left_camera, rig.right_camera})
                EXPECT_GE(share_of_ring(head, device, rig_from_ct, landmark), 0.8) << k << ": " << landmark.transpose();
    }
}

}  // namespace
}  // namespace planlight
