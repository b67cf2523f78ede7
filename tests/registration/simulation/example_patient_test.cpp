#include <gtest/gtest.h>

#include <chrono>

#include "planning_io/volume/invesalius_project.h"
#include "registration/simulation/simulated_rig.h"
#include "registration/simulation/true_surface.h"
#include "tests/support/test_data.h"

namespace planlight::simulation {

using Eigen::Vector3d;

TEST(ExamplePatient, LiesInTheRoomWithoutTheHeadHolderOfTheScanner) {
    const auto file = test::example_patient();
    if (!file) GTEST_SKIP() << "Debian's invesalius-examples is not installed";
    const Volume volume = read_invesalius_volume(*file);
    const TrueSurface skin(volume, -300);
    const Vector3d low = skin.low_in_ct(), high = skin.high_in_ct();
    // The holder is a trough 240 mm wide that reaches the edge of the volume; the head with its ears is 185 mm wide.
    EXPECT_GT(high.x() - low.x(), 150);
    EXPECT_LT(high.x() - low.x(), 200);
    EXPECT_GT(high.z() - low.z(), 155);
    // Skin is where the CT says so: the field crosses the threshold there.
    const Vector3d forehead = skin.nearest({122, low.y(), low.z() + 100}).p_in_ct;
    EXPECT_LT(forehead.y(), (low.y() + high.y()) / 2);  // in LPS the face looks towards -y
    EXPECT_NEAR(skin.nearest(forehead).signed_mm, 0, 0.01);
}

TEST(ExamplePatient, CarriesSixMarkersOffThePlan) {
    const auto file = test::example_patient();
    if (!file) GTEST_SKIP() << "Debian's invesalius-examples is not installed";
    const Volume volume = read_invesalius_volume(*file);
    RoomSettings settings;
    settings.preset = Preset::paper;
    settings.seed = 3;
    const TrueSurface skin(volume, settings.skin_threshold_hu);
    const Vector3d front(skin.middle_in_ct().x(), skin.low_in_ct().y(), skin.low_in_ct().z() + 105);
    std::vector<Vector3d> plan;
    for (const Vector3d& way : {Vector3d(0, 0, 0), Vector3d(20, 0, 0), Vector3d(0, 0, 20)})
        plan.push_back(skin.nearest(front + way).p_in_ct);
    const SimulatedRig rig(volume, plan, settings);
    const auto& markers = rig.true_markers_in_ct();
    ASSERT_GE(markers.size(), 6U);
    for (std::size_t i = 0; i < markers.size(); ++i) {
        for (const Vector3d& p : plan) EXPECT_GE((markers[i] - p).norm(), 15);
        for (std::size_t j = 0; j < i; ++j) EXPECT_GE((markers[i] - markers[j]).norm(), 25);
    }
}

}  // namespace planlight::simulation
