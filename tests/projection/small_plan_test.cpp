// Plans of few points, or of little extent: a turned or flipped copy of one fits the skin somewhere by chance.
#include <gtest/gtest.h>

#include <cmath>

#include "projection/check_plan.h"
#include "projection/said_frame.h"
#include "tests/projection/shapes.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using test::on_ball;
constexpr double kRadius_mm = test::kBallRadius_mm;

bool said(const std::vector<std::string>& sentences, const std::string& text) {
    return std::ranges::any_of(sentences, [&](const std::string& s) { return s.find(text) != std::string::npos; });
}

SkinSurface ball_about(const Vector3d& centre) {
    TriangleMesh mesh = test::ball_mesh(kRadius_mm, 5);
    for (Vector3d& p : mesh.vertices_in_ct) p += centre;
    return SkinSurface(std::move(mesh));
}

/// A ring of 40 mm about the third axis, on a ball of this radius about `centre`.
Plan ring_on_top(double radius_mm, const Vector3d& centre) {
    OsteotomyLine ring{"Trepanation", {}, true, {}};
    for (int i = 0; i < 8; ++i)
        ring.points_in_ct.push_back(centre + radius_mm / kRadius_mm * on_ball(i * M_PI / 4, 1.32));
    return Plan{{}, {}, {ring}, {}, {}};
}

// Of the 94 rarer copies of a small plan one fits somewhere by chance.
TEST(CheckPlan, APlanAtOneDepthUnderTheSkinIsNotStoppedForARareCopyThatFits) {
    const Vector3d centre(0, 0, 2.5);
    const Plan on_bone = ring_on_top(kRadius_mm - 5, centre);
    const PlanVerdict verdict = check_plan(on_bone, ball_about(centre));
    EXPECT_FALSE(said(verdict.stops, "exchanged or flipped")) << verdict.stops.front();
    EXPECT_TRUE(said(verdict.warnings, "may be exchanged or flipped, unless it was planned on the bone"));
    // Over the skin no bone lies.
    const Vector3d lower(0, 0, -2);
    EXPECT_TRUE(said(check_plan(ring_on_top(kRadius_mm + 4, lower), ball_about(lower)).stops, "exchanged or flipped"));
    // Half a turn is what LPS and RAS are exchanged by, and is stopped at any depth.
    const Vector3d aside(2.5, 0, 0);
    Plan turned = ring_on_top(kRadius_mm - 5, {0, 0, 0});
    for (Vector3d& p : turned.osteotomy_lines[0].points_in_ct) p = aside + Vector3d(p.z(), p.x(), p.y());
    EXPECT_TRUE(said(check_plan(turned, ball_about(aside)).stops, "read as (-x, -y, z)"));
}

// Too few points for a copy that fits to say anything; but the frame is nobody's but a person's word.
TEST(CheckPlan, FewPointsThatFitInTheOtherFrameAreDoubtedWhereAPersonSaidTheFrame) {
    const Vector3d aside(3, 2, 0);
    const SkinSurface skin = ball_about(aside);
    SaidFrame said_frame{Space::lps, {}};
    for (const double longitude : {0.2, 0.6, 1.0}) {
        const Vector3d entry = aside + on_ball(longitude, 0.3), turned(-entry.x(), -entry.y(), entry.z());
        said_frame.items.trajectories.push_back({"E", turned, 0.5 * turned, 3, {}});
        const std::string doubt = doubt_of_said_frame(said_frame, skin);
        EXPECT_NE(doubt.find("only --frame says that the plan is in LPS"), std::string::npos) << longitude;
        EXPECT_NE(doubt.find("in RAS it would lie within 0."), std::string::npos) << doubt;
    }
    SaidFrame right = said_frame;
    for (auto& t : right.items.trajectories)
        t.entry_in_ct = Vector3d(-t.entry_in_ct.x(), -t.entry_in_ct.y(), t.entry_in_ct.z());
    EXPECT_EQ(doubt_of_said_frame(right, skin), "");
    SaidFrame deeper = said_frame;  // in both frames it lies off the skin
    for (auto& t : deeper.items.trajectories) t.entry_in_ct *= 0.99;
    EXPECT_EQ(doubt_of_said_frame(deeper, skin), "");
    said_frame.space.reset();  // the file says it itself
    EXPECT_EQ(doubt_of_said_frame(said_frame, skin), "");
}

}  // namespace
}  // namespace planlight
