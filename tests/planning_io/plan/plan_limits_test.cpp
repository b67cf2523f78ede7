#include <gtest/gtest.h>

#include "planning_io/files/safe_write.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/plan/plan_import.h"
#include "planning_io/plan/plan_limits.h"
#include "planning_io/types/error.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

Plan plan_of(int boreholes, const std::string& name) {
    Plan plan;
    for (int i = 0; i < boreholes; ++i)
        plan.boreholes.push_back({name, Eigen::Vector3d(i % 20, i / 20, 5), std::nullopt, 2, 3, std::nullopt});
    return plan;
}

std::string import_of(const Plan& plan) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "plan.mrk.json";
    write_plan(plan, file);
    try {
        return std::to_string(import_plan(file).plan.size());
    } catch (const InputError& e) {
        EXPECT_FALSE(e.remedy.empty());
        return e.what();
    }
}

TEST(PlanLimits, WhatCanBeReadOnAHeadPassesAndWhatCannotIsRefusedWithTheLimit) {
    EXPECT_EQ(import_of(plan_of(300, "B")), "300");
    EXPECT_NE(import_of(plan_of(301, "B")).find("holds 301 items, more than the 300"), std::string::npos);
    EXPECT_NE(import_of(plan_of(1000, "B")).find("holds 1000 items"), std::string::npos);
    std::string name;
    for (int i = 0; i < 120; ++i) name += "ä";  // characters, not bytes
    EXPECT_EQ(import_of(plan_of(30, name)), "30");
    EXPECT_NE(import_of(plan_of(30, name + "x")).find("with 121 characters, more than the 120"), std::string::npos);
    const std::string said = import_of(plan_of(30, std::string(6000, 'n')));
    EXPECT_NE(said.find("with 6000 characters"), std::string::npos) << said;
    EXPECT_LT(said.size(), 400U) << "the sentence does not repeat the name";
}

TEST(PlanLimits, ALineOfTooManyPointsIsRefused) {
    Plan plan = plan_of(2, "B");
    plan.osteotomy_lines.push_back({"L", {}, false, std::nullopt});
    for (int i = 0; i <= 50000; ++i) plan.osteotomy_lines[0].points_in_ct.emplace_back(0.001 * i, 0, 0);
    EXPECT_THROW(check_plan_limits(plan, "plan"), InputError);
    plan.osteotomy_lines[0].points_in_ct.pop_back();
    EXPECT_NO_THROW(check_plan_limits(plan, "plan"));
}

TEST(PlanLimits, TextIsShortenedBetweenCharacters) {
    EXPECT_EQ(shortened("Bohrloch", 8), "Bohrloch");
    EXPECT_EQ(shortened("äöü", 2), "äö...");
}

}  // namespace
}  // namespace planlight
