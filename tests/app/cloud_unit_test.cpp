#include "app/commands/cloud_unit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

/// Half a ball of that radius, seen from the front, with a few stray points far away.
PointCloud half_ball(double radius_mm, double numbers_in_mm) {
    PointCloud cloud;
    for (int i = 0; i < 4000; ++i) {
        const double z = (i + 0.5) / 4000, turn = 2.399963 * i, r = std::sqrt(1 - z * z);
        cloud.points_in_rig.push_back(numbers_in_mm * radius_mm *
                                      Eigen::Vector3d(r * std::cos(turn), r * std::sin(turn), 10 - z));
    }
    for (int i = 0; i < 10; ++i) cloud.points_in_rig.push_back(numbers_in_mm * Eigen::Vector3d(3000, 10.0 * i, 0));
    return cloud;
}

std::string refusal(const PointCloud& cloud, const std::string& unit) {
    try {
        check_unit(cloud, unit, "cloud.ply");
        return {};
    } catch (const InputError& error) {
        return error.remedy;
    }
}

const std::map<std::string, double> kUnits{{"mm", 1}, {"cm", 10}, {"m", 1000}, {"um", 1e-3}, {"inch", 25.4}};

TEST(CloudUnit, AScanOfAHeadInItsOwnUnitIsNotRefused) {
    for (const double radius_mm : {45.0, 80.0, 120.0})
        for (const auto& [unit, mm] : kUnits) EXPECT_EQ(refusal(half_ball(radius_mm, 1), unit), "") << unit;
}

// The numbers a scanner wrote in one unit, read in another: the right one is among those that are named, at once or,
// where it might be a room, as a hint when nothing was found. (Centimetres and inches read as each other stay heads of
// 30 and of 600 mm, and are left to the match.)
TEST(CloudUnit, TheUnitThatWasMeantIsNamed) {
    for (const auto& [said, said_mm] : kUnits)
        for (const auto& [meant, meant_mm] : kUnits) {
            if (said == meant || said_mm * meant_mm == 254) continue;
            const PointCloud cloud = half_ball(80, said_mm / meant_mm);
            const std::string told = refusal(cloud, said) + hint_of_unit(cloud, said);
            EXPECT_NE(told.find("--unit " + meant), std::string::npos) << meant << " read as " << said << ": " << told;
        }
}

TEST(CloudUnit, AWholeRoomInMillimetresIsLeftToTheMatch) {
    EXPECT_EQ(refusal(half_ball(2000, 1), "mm"), "");
    EXPECT_EQ(refusal(half_ball(2000, 1), "m"), "");
}

TEST(CloudUnit, NoPointsAreNoQuestionOfUnits) {
    EXPECT_EQ(refusal({}, "mm"), "");
}

}  // namespace
}  // namespace planlight
