#include "registration/matching/scan_cells.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "planning_io/types/triangle_mesh.h"

namespace planlight {

using Eigen::Vector3d;

ScanCells scan_cells(const CloudPieces& pieces, const SkinLut& lut, const DistanceField& field,
                     const FindSkinSettings& settings, unsigned seed) {
    constexpr std::size_t kJudging = 1200;
    ScanCells scan{{}, {}, {}, lut, field, settings};
    for (std::size_t c = 0; c < pieces.cells.size(); ++c) {
        if (pieces.cells[c].stray) continue;
        scan.cells.push_back({pieces.cells[c].position.cast<double>(), pieces.cells[c].normal.cast<double>()});
        scan.of_pieces.push_back(static_cast<int>(c));
    }
    std::vector<int> order(scan.cells.size());
    std::iota(order.begin(), order.end(), 0);
    std::mt19937 random(seed);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
    order.resize(std::min(order.size(), kJudging));
    std::sort(order.begin(), order.end());
    scan.judging = std::move(order);
    return scan;
}

CellLying lying_of(const ScanCells& scan, const ScanCells::Cell& cell, const RigidTransform& ct_from_rig) {
    const Vector3d x = ct_from_rig * cell.position;
    CellLying lying;
    Vector3d gradient;
    if (!scan.field.sample(x, lying.mm, gradient)) return lying;
    lying.place = CellPlace::outside;
    if (lying.mm > scan.settings.near_mm) return lying;
    const SkinPoint* nearest = scan.lut.nearest_skin(x);
    if (!nearest || nearest->flags != kSkin) {
        lying.place = CellPlace::beyond;
        return lying;
    }
    if (lying.mm < -scan.settings.inside_mm)
        lying.place = CellPlace::inside;
    else if (std::abs(lying.mm) < scan.settings.near_mm &&
             gradient.dot(ct_from_rig.linear() * cell.normal) > kFacing * gradient.norm())
        lying.place = CellPlace::on;
    return lying;
}

double explained(const ScanCells& scan, const std::vector<int>& which, const RigidTransform& ct_from_rig) {
    double sum = 0;
    for (const int c : which) {
        const CellLying lying = lying_of(scan, scan.cells[static_cast<std::size_t>(c)], ct_from_rig);
        if (lying.place == CellPlace::on) {
            const double u = lying.mm / scan.settings.near_mm;
            sum += (1 - u * u) * (1 - u * u);
        } else if (lying.place == CellPlace::inside) {
            sum -= scan.settings.inside_penalty * std::min(1., -lying.mm / scan.settings.inside_mm - 1 + 0.3);
        }
    }
    return sum;
}

}  // namespace planlight
