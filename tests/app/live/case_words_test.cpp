#include <gtest/gtest.h>

#include "app/case_model.h"
#include "tests/support/analytic_head.h"

namespace planlight {
namespace {

OperatorModel model_of(const CaseNames& names) {
    Case the_case;
    the_case.code = "93e8e8b7";
    the_case.created = "2026-03-14T09:30:00Z";
    the_case.skin = test::analytic_head_mesh(8);
    the_case.names = names;
    return model_of_case(the_case, CaseDrawing(the_case));
}

// Two plans of one patient differ at a glance, whatever the case itself is called.
TEST(CaseInTheWindow, SaysWhosePlanItIsAndWhich) {
    CaseNames names;
    names.patient = "E. M.";
    names.plan = "Frontal defect";
    names.plan_version = "2";
    EXPECT_EQ(model_of(names).case_title, "E. M.");
    EXPECT_EQ(model_of(names).case_plan, "Frontal defect, version 2");
    names.title = "Second operation";
    EXPECT_EQ(model_of(names).case_plan, "Second operation, Frontal defect, version 2");
    names.plan.clear();
    EXPECT_EQ(model_of(names).case_plan, "Second operation, version 2");
    EXPECT_EQ(model_of({}).case_title, "Case 93e8e8b7");
    EXPECT_EQ(model_of({}).case_plan, "Plan without a name");
}

}  // namespace
}  // namespace planlight
