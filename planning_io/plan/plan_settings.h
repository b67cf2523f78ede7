#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "planning_io/types/plan.h"

namespace planlight {

/// The "key=value" words in the description of a plan item, in whatever file: diameter_mm, depth_mm, axis ...; other
/// words are the surgeon's own.
class PlanSettings {
public:
    using Refuse = std::function<void(const std::string& problem)>;  ///< must throw

    PlanSettings(const std::string& description, Refuse refuse);
    /// 0 when not given; refused unless it is a number from 0 to `most_mm`.
    double length_mm(const std::string& key, double most_mm) const;
    std::optional<std::string> text(const std::string& key) const;

private:
    std::map<std::string, std::string> values_;
    Refuse refuse_;
};

inline constexpr double kMaxDiameter_mm = 100;
inline constexpr double kMaxDepth_mm = 300;

/// A number so that it reads back bit for bit.
std::string exact(double value);

std::string description_of(const Trajectory& trajectory);  ///< "diameter_mm=2.1", or empty
std::string description_of(const Borehole& borehole);      ///< "diameter_mm=7 depth_mm=6"

}  // namespace planlight
