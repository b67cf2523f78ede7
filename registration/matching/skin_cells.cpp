#include "registration/matching/skin_cells.h"

#include <algorithm>
#include <cmath>

namespace planlight {

using Eigen::Vector3d;

std::vector<char> skin_cells(const CloudPieces& pieces, const ScanCells& scan, const RigidTransform& ct_from_rig) {
    constexpr double kAlone = 0.4, kHole = 0.6, kIsland = 0.1;
    std::vector<char> on(pieces.cells.size(), 0);
    for (std::size_t i = 0; i < scan.cells.size(); ++i)
        on[static_cast<std::size_t>(scan.of_pieces[i])] =
            lying_of(scan, scan.cells[i], ct_from_rig).place == CellPlace::on;
    const auto share_round = [&](const std::vector<char>& marks, std::size_t c) {
        const auto& touching = pieces.cells[c].touching;
        double count = 0;
        for (const int other : touching) count += marks[static_cast<std::size_t>(other)];
        return touching.empty() ? 0 : count / static_cast<double>(touching.size());
    };
    std::vector<char> opened = on;
    for (std::size_t c = 0; c < on.size(); ++c) opened[c] = on[c] && share_round(on, c) >= kAlone;
    std::vector<char> closed = opened;
    for (std::size_t c = 0; c < on.size(); ++c)
        closed[c] = opened[c] || (!pieces.cells[c].stray && share_round(opened, c) >= kHole);
    std::vector<char> kept(on.size(), 0), seen(on.size(), 0);
    std::vector<std::vector<int>> islands;
    std::size_t largest = 0;
    for (std::size_t c = 0; c < on.size(); ++c) {
        if (!closed[c] || seen[c]) continue;
        std::vector<int> island{static_cast<int>(c)};
        seen[c] = 1;
        for (std::size_t i = 0; i < island.size(); ++i)
            for (const int next : pieces.cells[static_cast<std::size_t>(island[i])].touching)
                if (closed[static_cast<std::size_t>(next)] && !seen[static_cast<std::size_t>(next)])
                    seen[static_cast<std::size_t>(next)] = 1, island.push_back(next);
        largest = std::max(largest, island.size());
        islands.push_back(std::move(island));
    }
    for (const auto& island : islands)
        if (static_cast<double>(island.size()) >= std::max(12., kIsland * static_cast<double>(largest)))
            for (const int c : island) kept[static_cast<std::size_t>(c)] = 1;
    return kept;
}

double goes_on(const CloudPieces& pieces, const ScanCells& scan, const RigidTransform& ct_from_rig,
               const std::vector<char>& skin) {
    constexpr double kBeside_mm = 10;
    std::vector<char> beside(pieces.cells.size(), 0);
    for (std::size_t i = 0; i < scan.cells.size(); ++i) {
        const auto c = static_cast<std::size_t>(scan.of_pieces[i]);
        double mm;
        Vector3d gradient;
        if (skin[c] || !scan.field.sample(ct_from_rig * scan.cells[i].position, mm, gradient)) continue;
        beside[c] = std::abs(mm) < kBeside_mm &&
                    lying_of(scan, scan.cells[i], ct_from_rig).place != CellPlace::beyond &&
                    gradient.dot(ct_from_rig.linear() * scan.cells[i].normal) > kFacing * gradient.norm();
    }
    std::vector<int> front;
    for (std::size_t c = 0; c < skin.size(); ++c)
        if (skin[c]) front.push_back(static_cast<int>(c));
    const auto count = static_cast<double>(front.size());
    for (std::size_t i = 0; i < front.size(); ++i) {
        const CloudCell& cell = pieces.cells[static_cast<std::size_t>(front[i])];
        for (const int next : cell.touching) {
            const auto n = static_cast<std::size_t>(next);
            if (!beside[n] || pieces.cells[n].piece != cell.piece) continue;
            beside[n] = 0;
            front.push_back(next);
        }
    }
    return count == 0 ? 0 : (static_cast<double>(front.size()) - count) / count;
}

}  // namespace planlight
