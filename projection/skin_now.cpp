#include "projection/skin_now.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "projection/surface_walk.h"

namespace planlight {

using Eigen::Vector3d;

SkinSurface skin_as_scanned(const TriangleMesh& ct_skin, const SkinDisplacementField& field) {
    TriangleMesh moved = ct_skin;
    if (!field.displacement().known()) return SkinSurface(std::move(moved));
    const bool has_normals = ct_skin.normals_in_ct.size() == ct_skin.vertices_in_ct.size();
    const std::vector<Vector3d> own = has_normals ? std::vector<Vector3d>{} : vertex_normals(ct_skin);
    const std::vector<Vector3d>& normals = has_normals ? ct_skin.normals_in_ct : own;
    tbb::parallel_for(std::size_t{0}, moved.vertices_in_ct.size(), [&](std::size_t i) {
        const Vector3d& p = ct_skin.vertices_in_ct[i];
        if (p.allFinite()) moved.vertices_in_ct[i] = p + field.at(p).mm * normals[i];
    });
    moved.normals_in_ct = vertex_normals(moved);
    return SkinSurface(std::move(moved));
}

namespace {

constexpr double kWorthSaying = 0.1;  // of an item

template <class Use>
void for_points_of(const PlanDrawing& planned, std::size_t item, const Use& use) {
    for (const Stroke& stroke : planned.strokes)
        if (stroke.item == static_cast<int>(item) && stroke.kind != StrokeKind::label)
            for (const Vector3d& p : stroke.points_in_ct) use(p);
}

}  // namespace

std::optional<std::string> covered_in_words(const PlanDrawing& planned, std::size_t item,
                                            const SkinDisplacement& skin) {
    double points = 0, covered = 0, most_mm = 0;
    if (skin.covered.empty()) return std::nullopt;
    for_points_of(planned, item, [&](const Vector3d& p) {
        ++points;
        if (const auto mm = covered_by_mm(skin, p)) ++covered, most_mm = std::max(most_mm, *mm);
    });
    if (covered == 0 || covered < kWorthSaying * points) return std::nullopt;
    return fmt::format(
        "{}: over {:.0f} % of it the scan saw a surface up to {:.0f} mm outside the skin of the CT; the skin is "
        "swollen there, or something lies on it",
        planned.items[item].name, 100 * covered / points, most_mm);
}

void warn_of_unscanned(const SkinDisplacementField& field, const PlanDrawing& planned, PlanDrawing& drawing) {
    const SkinDisplacement& skin = field.displacement();
    if (!skin.known()) return;
    for (std::size_t index = 0; index < std::min(planned.items.size(), drawing.items.size()); ++index) {
        DrawnItem& item = drawing.items[index];
        if (auto covered = covered_in_words(planned, index, skin)) item.warnings.push_back(std::move(*covered));
        double points = 0, unseen = 0, sigma_mm = 0;
        for_points_of(planned, index, [&](const Vector3d& p) {
            ++points;
            const auto value = field.at(p);
            if (value.scanned || covered_by_mm(skin, p)) return;
            ++unseen;
            sigma_mm = std::max(sigma_mm, value.sigma_mm);
        });
        if (unseen == 0 || unseen < kWorthSaying * points) continue;
        item.warnings.push_back(
            fmt::format("{}: {:.0f} % of it lies where the scan saw no skin; the skin there is taken to lie {:.1f} mm "
                        "{} that of the CT, "
                        "as most of the rest does, give or take {:.1f} mm (95 %)",
                        item.name, 100 * unseen / points, std::abs(skin.offset_mm),
                        skin.offset_mm < 0 ? "inside" : "outside", 2 * sigma_mm));
    }
}

}  // namespace planlight
