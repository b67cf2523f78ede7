#include <gtest/gtest.h>

#include "app/case_model.h"

namespace planlight {
namespace {

TEST(PlanRows, AreCalledAsTheLightCallsTheirItems) {
    PlanDrawing drawing;
    drawing.items.resize(3);
    drawing.items[0].name = "Line", drawing.items[0].label = "Line  164 mm", drawing.items[0].code = "#A";
    drawing.items[1].name = "B1", drawing.items[1].label = "B1  7 mm wide", drawing.items[1].code = "#B";
    drawing.items[1].lit_by_code = true;
    drawing.items[2].name = "T1";
    std::vector<PlanRow> rows(3);
    name_rows(drawing, rows);
    EXPECT_EQ(rows[0].name, "Line  164 mm");
    EXPECT_EQ(rows[1].name, "#B  B1  7 mm wide");
    EXPECT_EQ(rows[2].name, "T1");
    drawing.items[1].lit_by_code = false;  // another match, with room for its name
    name_rows(drawing, rows);
    EXPECT_EQ(rows[1].name, "B1  7 mm wide");
}

}  // namespace
}  // namespace planlight
