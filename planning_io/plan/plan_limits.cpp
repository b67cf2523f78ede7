#include "planning_io/plan/plan_limits.h"

#include <fmt/format.h>

#include <algorithm>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

bool begins_character(char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
}

void check_name(const std::string& name, const fs::path& file, const PlanLimits& limits) {
    const std::size_t length = characters_of(name);
    if (length > limits.name_characters)
        throw InputError(
            file,
            fmt::format("names an item \"{}\" with {} characters, more than the {} that can be read on skin",
                        shortened(name, 40), length, limits.name_characters),
            "Shorten the name.");
}

}  // namespace

std::size_t characters_of(const std::string& utf8) {
    return static_cast<std::size_t>(std::count_if(utf8.begin(), utf8.end(), begins_character));
}

std::string shortened(const std::string& utf8, std::size_t most) {
    std::size_t seen = 0;
    for (std::size_t i = 0; i < utf8.size(); ++i)
        if (begins_character(utf8[i]) && seen++ == most) return utf8.substr(0, i) + "...";
    return utf8;
}

void check_plan_limits(const Plan& plan, const fs::path& file, const PlanLimits& limits) {
    if (plan.size() > limits.items)
        throw InputError(
            file,
            fmt::format("holds {} items, more than the {} that can be told apart on a head", plan.size(), limits.items),
            "Give the items that are to be shown, and the others as a plan of their own.");
    std::size_t points = 0;
    for (const auto& line : plan.osteotomy_lines) points += line.points_in_ct.size();
    if (points > limits.points)
        throw InputError(file, fmt::format("holds lines of {} points, more than {}", points, limits.points),
                         "Thin the lines out: a point every half millimetre is enough.");
    for (const auto& t : plan.trajectories) check_name(t.name, file, limits);
    for (const auto& b : plan.boreholes) check_name(b.name, file, limits);
    for (const auto& line : plan.osteotomy_lines) check_name(line.name, file, limits);
    for (const auto& c : plan.cut_planes) check_name(c.name, file, limits);
}

}  // namespace planlight
