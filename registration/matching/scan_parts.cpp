#include "registration/matching/scan_parts.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace planlight {
namespace {

using Eigen::Vector3d;

/// The cells within reach of one, gone to over the surface; `within_piece`: over no crease.
std::vector<int> cells_round(const CloudPieces& pieces, int start, double reach_mm, bool within_piece) {
    std::vector<int> found{start};
    std::vector<char> seen(pieces.cells.size(), 0);
    seen[static_cast<std::size_t>(start)] = 1;
    const CloudCell& first = pieces.cells[static_cast<std::size_t>(start)];
    for (std::size_t i = 0; i < found.size(); ++i)
        for (const int next : pieces.cells[static_cast<std::size_t>(found[i])].touching) {
            const CloudCell& cell = pieces.cells[static_cast<std::size_t>(next)];
            if (seen[static_cast<std::size_t>(next)] || (within_piece && cell.piece != first.piece)) continue;
            seen[static_cast<std::size_t>(next)] = 1;
            if ((cell.position - first.position).norm() < reach_mm) found.push_back(next);
        }
    return found;
}

/// The weakest way's share of the information of point to plane: nothing for a plane, a ball or a cylinder.
double holds_a_pose(const CloudPieces& pieces, const std::vector<int>& part, double reach_mm) {
    Vector3d middle = Vector3d::Zero();
    for (const int c : part)
        middle += pieces.cells[static_cast<std::size_t>(c)].position.cast<double>() / static_cast<double>(part.size());
    Eigen::Matrix<double, 6, 6> H = Eigen::Matrix<double, 6, 6>::Zero();
    for (const int c : part) {
        const CloudCell& cell = pieces.cells[static_cast<std::size_t>(c)];
        const Vector3d n = cell.normal.cast<double>();
        Eigen::Matrix<double, 6, 1> row;
        row << (cell.position.cast<double>() - middle).cross(n) / (0.7 * reach_mm), n;
        H += row * row.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(H, Eigen::EigenvaluesOnly);
    return std::max(solver.eigenvalues()(0), 0.);
}

}  // namespace

std::vector<ScanPart> scan_parts(const CloudPieces& pieces, const ScanCells& scan, const FindSkinSettings& settings) {
    constexpr double kApart_mm = 22, kThinly_mm = 40, kFlat = 1e-3;
    std::vector<ScanPart> parts;
    if (scan.cells.empty()) return parts;
    std::vector<double> nearest_mm(scan.cells.size(), std::numeric_limits<double>::infinity());
    std::size_t next = 0, thin = 0;
    for (double apart_mm = kThinly_mm; apart_mm >= kApart_mm; apart_mm = nearest_mm[next]) {
        if (apart_mm >= kThinly_mm) thin = parts.size();
        for (std::size_t i = 0; i < scan.cells.size(); ++i)
            nearest_mm[i] = std::min(nearest_mm[i], (scan.cells[i].position - scan.cells[next].position).norm());
        std::vector<int> alone = cells_round(pieces, scan.of_pieces[next], settings.reach_mm, true);
        std::vector<int> with_others = cells_round(pieces, scan.of_pieces[next], settings.reach_mm, false);
        const bool same = 100 * with_others.size() < 115 * alone.size();
        for (auto* cells : {&alone, &with_others}) {
            if (cells->size() < kLeastScanCells || (same && cells == &alone)) continue;
            const double holds = holds_a_pose(pieces, *cells, settings.reach_mm);
            if (holds > kFlat * static_cast<double>(cells->size())) parts.push_back({std::move(*cells), holds});
        }
        next = static_cast<std::size_t>(std::max_element(nearest_mm.begin(), nearest_mm.end()) - nearest_mm.begin());
    }
    const auto better = [](const ScanPart& a, const ScanPart& b) { return a.holds > b.holds; };
    std::stable_sort(parts.begin(), parts.begin() + static_cast<std::ptrdiff_t>(thin), better);
    std::stable_sort(parts.begin() + static_cast<std::ptrdiff_t>(thin), parts.end(), better);
    if (parts.size() > static_cast<std::size_t>(settings.max_places))
        parts.resize(static_cast<std::size_t>(settings.max_places));
    return parts;
}

}  // namespace planlight
