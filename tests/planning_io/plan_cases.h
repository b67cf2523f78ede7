#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "planning_io/plan/plan_import.h"
#include "projection/check_plan.h"

namespace planlight::test {

/// A plan file made by a test, sound or spoilt in one way.
struct PlanCase {
    std::string name;  ///< in words, for the table
    std::string says;  ///< a part of the refusal's sentence; empty: it is to be read
    std::function<std::filesystem::path(const std::filesystem::path& empty_folder)>
        make;  ///< what to give to import_plan
    PlanImportSettings settings;
};

/// Every format and frame that is read. The first point of each plan is (-10, -20, 30) in ct.
std::vector<PlanCase> sound_plans();

/// Every kind of file that is to be refused.
std::vector<PlanCase> spoilt_plans();

/// A plan for the patient of `analytic_head_mesh`: sound where `says` is empty, else to be stopped with these words.
struct PlanOnHead {
    std::string name, says;
    Plan plan;
};
std::vector<PlanOnHead> plans_on_head();
/// The volume that this patient was scanned in: 320 mm across, round the origin.
VolumeBox box_of_head();

/// For a failed test's message.
inline void PrintTo(const PlanCase& c, std::ostream* out) {
    *out << c.name;
}

}  // namespace planlight::test
