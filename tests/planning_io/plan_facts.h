#pragma once

#include <gtest/gtest.h>

#include "planning_io/types/plan.h"

namespace planlight::test {

/// Every value of two plans is equal: coordinates within `mm`, colours within `colour` (0: bit for bit).
inline void expect_same(const Plan& a, const Plan& b, double mm = 0, double colour = 0) {
    const auto near = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
        EXPECT_LE((p - q).cwiseAbs().maxCoeff(), mm) << p.transpose() << " | " << q.transpose();
    };
    const auto same_colour = [&](const std::optional<Colour>& c, const std::optional<Colour>& d,
                                 const std::string& name) {
        ASSERT_EQ(c.has_value(), d.has_value()) << name;
        for (std::size_t i = 0; c && i < 3; ++i)
            EXPECT_LE(std::abs(static_cast<double>((*c)[i]) - static_cast<double>((*d)[i])), colour) << name;
    };
    ASSERT_EQ(a.trajectories.size(), b.trajectories.size());
    for (std::size_t i = 0; i < a.trajectories.size(); ++i) {
        const auto &s = a.trajectories[i], &t = b.trajectories[i];
        EXPECT_EQ(s.name, t.name);
        near(s.entry_in_ct, t.entry_in_ct);
        near(s.target_in_ct, t.target_in_ct);
        EXPECT_EQ(s.diameter_mm, t.diameter_mm) << s.name;
        same_colour(s.colour, t.colour, s.name);
    }
    ASSERT_EQ(a.boreholes.size(), b.boreholes.size());
    for (std::size_t i = 0; i < a.boreholes.size(); ++i) {
        const auto &s = a.boreholes[i], &t = b.boreholes[i];
        EXPECT_EQ(s.name, t.name);
        near(s.position_in_ct, t.position_in_ct);
        ASSERT_EQ(s.axis_in_ct.has_value(), t.axis_in_ct.has_value()) << s.name;
        if (s.axis_in_ct) near(*s.axis_in_ct, *t.axis_in_ct);
        EXPECT_EQ(s.diameter_mm, t.diameter_mm) << s.name;
        EXPECT_EQ(s.depth_mm, t.depth_mm) << s.name;
        same_colour(s.colour, t.colour, s.name);
    }
    ASSERT_EQ(a.osteotomy_lines.size(), b.osteotomy_lines.size());
    for (std::size_t i = 0; i < a.osteotomy_lines.size(); ++i) {
        const auto &s = a.osteotomy_lines[i], &t = b.osteotomy_lines[i];
        EXPECT_EQ(s.name, t.name);
        EXPECT_EQ(s.closed, t.closed) << s.name;
        ASSERT_EQ(s.points_in_ct.size(), t.points_in_ct.size()) << s.name;
        for (std::size_t p = 0; p < s.points_in_ct.size(); ++p) near(s.points_in_ct[p], t.points_in_ct[p]);
        same_colour(s.colour, t.colour, s.name);
    }
    ASSERT_EQ(a.cut_planes.size(), b.cut_planes.size());
    for (std::size_t i = 0; i < a.cut_planes.size(); ++i) {
        const auto &s = a.cut_planes[i], &t = b.cut_planes[i];
        EXPECT_EQ(s.name, t.name);
        near(s.origin_in_ct, t.origin_in_ct);
        near(s.normal_in_ct, t.normal_in_ct);
        near(s.first_axis_in_ct, t.first_axis_in_ct);
        EXPECT_NEAR(s.width_mm, t.width_mm, mm) << s.name;
        EXPECT_NEAR(s.height_mm, t.height_mm, mm) << s.name;
        same_colour(s.colour, t.colour, s.name);
    }
}

/// A plan of every kind of item, everything random: also names that need care in files, sizes of zero, no colour, no
/// axis.
Plan random_plan(unsigned seed);

}  // namespace planlight::test
