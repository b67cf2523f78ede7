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

void warn_of_unscanned(const SkinDisplacementField& field, const PlanDrawing& planned, PlanDrawing& drawing) {
    constexpr double kWorthSaying = 0.1;
    if (!field.displacement().known()) return;
    for (std::size_t index = 0; index < std::min(planned.items.size(), drawing.items.size()); ++index) {
        std::size_t points = 0, unseen = 0, covered = 0;
        double sigma_mm = 0, cover_mm = 0;
        for (const Stroke& stroke : planned.strokes) {
            if (stroke.item != static_cast<int>(index) || stroke.kind == StrokeKind::label) continue;
            for (const Vector3d& p : stroke.points_in_ct) {
                const auto value = field.at(p);
                ++points;
                if (const auto mm = covered_by_mm(field.displacement(), p)) {
                    ++covered;
                    cover_mm = std::max(cover_mm, *mm);
                } else if (!value.scanned) {
                    ++unseen;
                    sigma_mm = std::max(sigma_mm, value.sigma_mm);
                }
            }
        }
        const auto worth_saying = [&](std::size_t count) {
            return count > 0 && static_cast<double>(count) >= kWorthSaying * static_cast<double>(points);
        };
        if (worth_saying(covered))
            drawing.items[index].warnings.push_back(
                fmt::format("{}: over {:.0f} % of it the scan saw a surface up to {:.0f} mm outside the skin of the "
                            "CT; the skin is "
                            "swollen there, or something lies on it",
                            drawing.items[index].name,
                            100. * static_cast<double>(covered) / static_cast<double>(points), cover_mm));
        if (!worth_saying(unseen)) continue;
        DrawnItem& item = drawing.items[index];
        item.warnings.push_back(
            fmt::format("{}: {:.0f} % of it lies where the scan saw no skin; the skin there is taken to lie {:.1f} mm "
                        "{} that of the CT, "
                        "as most of the rest does, give or take {:.1f} mm (95 %)",
                        item.name, 100. * static_cast<double>(unseen) / static_cast<double>(points),
                        std::abs(field.displacement().offset_mm),
                        field.displacement().offset_mm < 0 ? "inside" : "outside", 2 * sigma_mm));
    }
}

}  // namespace planlight
