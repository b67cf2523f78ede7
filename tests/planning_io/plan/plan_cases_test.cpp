#include <gtest/gtest.h>

#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"
#include "projection/check_plan.h"
#include "tests/planning_io/plan_cases.h"
#include "tests/support/analytic_head.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

TEST(PlanCases, ASoundPlanOfEveryFormatStandsWhereItsNumbersSay) {
    for (const auto& c : sound_plans()) {
        const TemporaryFolder folder;
        const auto points = points_of(import_plan(c.make(folder.path()), c.settings).plan);
        ASSERT_FALSE(points.empty()) << c.name;
        EXPECT_TRUE(points.front().isApprox(Vector3d(-10, -20, 30), 1e-7))
            << c.name << ": " << points.front().transpose();
    }
}

TEST(PlanCases, ASpoiltPlanIsRefusedWithItsReasonAndARemedy) {
    for (const auto& c : spoilt_plans()) {
        const TemporaryFolder folder;
        const auto path = c.make(folder.path());
        try {
            import_plan(path, c.settings);
            ADD_FAILURE() << c.name << " was read";
        } catch (const Error& e) {
            EXPECT_NE((std::string(e.what()) + ". " + e.remedy).find(c.says), std::string::npos)
                << c.name << ": " << e.what();
            EXPECT_FALSE(c.says.empty()) << c.name;
            EXPECT_FALSE(e.remedy.empty()) << c.name;
        }
    }
}

TEST(PlanCases, APlanThatDoesNotFitTheHeadIsStoppedByNameAndNumber) {
    const SkinSurface skin(analytic_head_mesh(4));
    for (const auto& c : plans_on_head()) {
        std::string stops;
        for (const auto& stop : check_plan(c.plan, skin, box_of_head()).stops) stops += stop + "\n";
        EXPECT_EQ(c.says.empty(), stops.empty()) << c.name << ": " << stops;
        EXPECT_NE(stops.find(c.says), std::string::npos) << c.name << ": " << stops;
    }
}

}  // namespace
}  // namespace planlight::test
