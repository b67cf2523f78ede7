#include "projection/said_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "projection/plan_alternatives.h"
#include "projection/skin_points.h"

namespace planlight {

using Eigen::Vector3d;

std::string doubt_of_said_frame(const SaidFrame& said, const SkinSurface& skin) {
    constexpr double kOn_mm = 0.3, kOff_mm = 2, kAll = 1;
    if (!said.space) return {};
    std::vector<Vector3d> points;
    const auto add = [&](const auto& items) {
        for (const auto& item : items)
            for (const Vector3d& p : skin_points(item)) points.push_back(p);
    };
    add(said.items.trajectories);
    add(said.items.boreholes);
    add(said.items.osteotomy_lines);
    const bool finite = std::ranges::all_of(points, [](const Vector3d& p) { return p.allFinite(); });
    if (points.empty() || !finite || tells_by_copies(points)) return {};
    std::vector<Vector3d> turned;
    for (const Vector3d& p : points) turned.push_back(to_ct(p, Space::ras));
    const double given_mm = distance_quantile(points, skin, kAll), turned_mm = distance_quantile(turned, skin, kAll);
    if (given_mm <= kOff_mm || turned_mm > kOn_mm) return {};
    const Space other = *said.space == Space::lps ? Space::ras : Space::lps;
    return fmt::format(
        "only --frame says that the plan is in {}: so it lies up to {:.1f} mm off the skin, in {} it would lie within "
        "{:.1f} mm. Ask the program that wrote it, or the person who planned, which of the two it is",
        name_of(*said.space), given_mm, name_of(other), turned_mm);
}

}  // namespace planlight
