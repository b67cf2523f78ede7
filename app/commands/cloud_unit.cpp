#include "app/commands/cloud_unit.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

constexpr std::pair<const char*, double> kUnits[] = {{"mm", 1}, {"cm", 10}, {"m", 1000}, {"um", 1e-3}, {"inch", 25.4}};

double extent_mm(const PointCloud& cloud) {
    Eigen::Vector3d extent = Eigen::Vector3d::Zero();
    std::vector<double> values(cloud.size());
    const auto rank = static_cast<std::ptrdiff_t>(cloud.size() / 100);
    for (int axis = 0; axis < 3; ++axis) {
        for (std::size_t i = 0; i < cloud.size(); ++i) values[i] = cloud.points_in_rig[i][axis];
        std::nth_element(values.begin(), values.begin() + rank, values.end());
        const double low = values[static_cast<std::size_t>(rank)];
        std::nth_element(values.begin(), values.end() - 1 - rank, values.end());
        extent[axis] = *(values.end() - 1 - rank) - low;
    }
    return extent.norm();
}

/// "--unit cm or --unit inch": the units in which the cloud would be as large as a scan of a head.
std::string better_units(double across_mm, const std::string& unit) {
    constexpr double kLeast_mm = 100, kMost_mm = 500;
    std::string others;
    for (const auto& [name, mm] : kUnits)
        if (const double other_mm = across_mm / unit_in_mm(unit) * mm; other_mm >= kLeast_mm && other_mm <= kMost_mm)
            others += fmt::format("{}--unit {}", others.empty() ? "" : " or ", name);
    return others;
}

}  // namespace

double unit_in_mm(const std::string& unit) {
    for (const auto& [name, mm] : kUnits)
        if (unit == name) return mm;
    return 1;
}

void check_unit(const PointCloud& cloud, const std::string& unit, const std::filesystem::path& file) {
    constexpr double kSmall_mm = 50, kLarge_mm = 20'000;
    if (cloud.size() == 0) return;
    const double across_mm = extent_mm(cloud);
    if (across_mm >= kSmall_mm && across_mm <= kLarge_mm) return;
    const std::string others = better_units(across_mm, unit);
    if (others.empty()) return;
    throw InputError(
        file, fmt::format("is {:.3g} mm across if its numbers are {}, which is no scan of a head", across_mm, unit),
        fmt::format("Say {}, if that is what the scanner writes.", others));
}

std::string hint_of_unit(const PointCloud& cloud, const std::string& unit) {
    constexpr double kLarge_mm = 1000;
    if (cloud.size() == 0) return {};
    const double across_mm = extent_mm(cloud);
    const std::string others = across_mm > kLarge_mm ? better_units(across_mm, unit) : std::string();
    if (others.empty()) return {};
    return fmt::format(" The cloud is {:.2g} m across: if its numbers are not {}, say {}.", across_mm / 1000, unit,
                       others);
}

}  // namespace planlight
