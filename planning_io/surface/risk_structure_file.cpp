#include "planning_io/surface/risk_structure_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "planning_io/files/check_exists.h"
#include "planning_io/files/one_line.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/plan/plan_limits.h"
#include "planning_io/surface/dicom_seg.h"
#include "planning_io/surface/roi_surface.h"
#include "planning_io/surface/surface_file.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

bool is_dicom(const fs::path& file) {
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
    return ending == ".dcm" || is_dicom_file(file);  // old ones have no "DICM" at byte 128
}

void check_name(const std::string& name, const fs::path& file) {
    constexpr std::size_t kMost = PlanLimits{}.name_characters, kShown = 40;
    if (name.empty()) throw InputError(file, "holds a risk structure without a name", "Name the structure.");
    if (characters_of(name) > kMost)
        throw InputError(file,
                         fmt::format("names a risk structure \"{}\" with {} characters (at most {})",
                                     shortened(name, kShown), characters_of(name), kMost),
                         "Shorten the name.");
}

void check_count(std::size_t triangles, const std::string& name, const fs::path& file, const RiskLimits& limits) {
    if (triangles > limits.triangles)
        throw InputError(
            file,
            fmt::format("risk structure \"{}\" has {} triangles, more than {}", name, triangles, limits.triangles),
            "Thin its surface out and export it again.");
}

void check_size(const RiskStructure& structure, const fs::path& file, const RiskLimits& limits) {
    const TriangleMesh& mesh = structure.surface;
    if (mesh.triangles.empty())
        throw InputError(file, fmt::format("risk structure \"{}\" holds no triangles", structure.name),
                         "Export its closed surface.");
    check_count(mesh.triangles.size(), structure.name, file, limits);
    Vector3d low = mesh.vertices_in_ct.front(), high = low;
    for (const auto& p : mesh.vertices_in_ct) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    const double across_mm = (high - low).maxCoeff();
    if (!(across_mm >= limits.least_across_mm) || across_mm > limits.most_across_mm)
        throw InputError(
            file,
            fmt::format("risk structure \"{}\" is {:.3g} mm across, not between {:.0f} and {:.0f} mm", structure.name,
                        across_mm, limits.least_across_mm, limits.most_across_mm),
            across_mm < limits.least_across_mm ? "Export it in mm (it seems to be in metres)." : "Export it in mm.");
}

void check_closed(const SurfaceFile& surface, const std::string& name, const fs::path& file) {
    if (!surface.closed)
        throw InputError(file,
                         fmt::format("risk structure \"{}\" is an open surface ({} edges at its border): it has no "
                                     "inside that could be hurt",
                                     name, surface.border_edges),
                         "Close its holes and export it again.");
}

RiskStructure read_shape_structure(const fs::path& file, const PlanImportSettings& settings, const RiskLimits& limits,
                                   std::vector<std::string>& notes) {
    const Shape shape = read_shape(file);
    RiskStructure structure{plan_name_of(file), {}};
    check_count(shape.triangles.size(), structure.name, file, limits);  // before all that takes long
    const Space space = settled_space(shape.space, settings.space, file,
                                      "Export it with its space (3D Slicer does: SPACE=LPS)", limits.space_option);
    const WeldedShape read = welded(shape);
    if (read.shape.triangles.empty())
        throw InputError(file, "holds no triangles: no surface of a risk structure",
                         "Export its closed surface; lines are given as the plan.");
    SurfaceFile surface = surface_of(read.shape, space, read.degenerate, file);
    check_closed(surface, structure.name, file);
    if (surface.pieces > 1)
        notes.push_back(fmt::format("{}: the risk structure consists of {} pieces; the nearest of them counts",
                                    file.filename().string(), surface.pieces));
    structure.surface = std::move(surface.mesh);
    return structure;
}

}  // namespace

std::vector<RiskStructure> read_risk_structures(const fs::path& file, const PlanImportSettings& settings,
                                                std::vector<std::string>& notes, const RiskLimits& limits) {
    check_exists(file);
    if (!fs::is_regular_file(file))
        throw InputError(file, "is no file", "Give each risk structure's file by itself: --risk FILE --risk FILE.");
    std::vector<RiskStructure> structures;
    if (is_dicom(file)) {
        if (settings.space == Space::ras)
            throw InputError(file, "is DICOM, which is always LPS; " + limits.space_option + " says RAS",
                             "Leave " + limits.space_option + " out.");
        structures = read_roi_solids(file, settings, notes);
    } else {
        structures.push_back(read_shape_structure(file, settings, limits, notes));
    }
    for (auto& structure : structures) {
        structure.name = on_one_line(structure.name);
        check_name(structure.name, file);
        check_size(structure, file, limits);
        structure.surface.normals_in_ct.clear();  // nobody looks at them
        structure.surface.flags.clear();
    }
    return structures;
}

void append_risk_structures(PlanImport& plan, const std::vector<fs::path>& files, const PlanImportSettings& settings,
                            const RiskLimits& limits) {
    auto& all = plan.plan.risk_structures;
    for (const auto& file : files) {
        auto more = read_risk_structures(file, settings, plan.notes, limits);
        std::move(more.begin(), more.end(), std::back_inserter(all));
        if (all.size() > limits.structures)
            throw InputError(file,
                             fmt::format("makes it {} risk structures, more than {}", all.size(), limits.structures),
                             "Give those that lie near the plan.");
    }
}

}  // namespace planlight
