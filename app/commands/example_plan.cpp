#include "app/commands/example_plan.h"

#include <filesystem>

#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"

namespace planlight {

Plan example_plan() {
    namespace fs = std::filesystem;
    const fs::path name = "frontal_defect.mrk.json";
    std::error_code ignored;
    const fs::path file =
        fs::read_symlink("/proc/self/exe", ignored).parent_path().parent_path() / "share" / "planlight" / name;
    if (fs::exists(file)) return read_plan(file);
    throw InputError(file, "the example plan is not there", "Give a plan with --plan.");
}

}  // namespace planlight
