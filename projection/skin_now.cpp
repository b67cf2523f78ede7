#include "projection/skin_now.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

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

void warn_of_unscanned(const SkinDisplacementField& field, PlanDrawing& drawing) {
    constexpr double kWorthSaying = 0.1;
    if (!field.displacement().known()) return;
    for (std::size_t index = 0; index < drawing.items.size(); ++index) {
        std::size_t points = 0, unseen = 0;
        double sigma_mm = 0;
        for (const Stroke& stroke : drawing.strokes) {
            if (stroke.item != static_cast<int>(index) || stroke.kind == StrokeKind::label) continue;
            for (const Vector3d& p : stroke.points_in_ct) {
                const auto value = field.at(p);
                ++points;
                unseen += value.scanned ? 0 : 1;
                if (!value.scanned) sigma_mm = std::max(sigma_mm, value.sigma_mm);
            }
        }
        if (unseen == 0 || static_cast<double>(unseen) < kWorthSaying * static_cast<double>(points)) continue;
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
