#include "projection/line_crossing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace planlight {
namespace {

using Eigen::Vector3d;
using Cell = std::array<int, 3>;

constexpr double kCell_mm = 4;

Cell cell_of(const Vector3d& p) {
    const Eigen::Vector3i cell = (p / kCell_mm).array().floor().cast<int>();
    return {cell.x(), cell.y(), cell.z()};
}

}  // namespace

void LineCrossing::add(const SkinLine& leg, std::size_t number) {
    for (std::size_t i = 0; i + 1 < leg.points.size(); ++i) {
        const auto &a = leg.points[i], &b = leg.points[i + 1];
        pieces_.push_back({a.p_in_ct, b.p_in_ct, a.normal_in_ct + b.normal_in_ct, way_mm_, number});
        way_mm_ += (b.p_in_ct - a.p_in_ct).norm();
    }
}

/// In the tangent plane of both; pieces one above the other, as on both sides of a lid or an ear, do not cross.
bool LineCrossing::cross(const Piece& a, const Piece& b) {
    constexpr double kAbove_mm = 1.5, kAlong = 0.1;
    const Vector3d normal = (a.normal + b.normal).normalized();
    const Vector3d u = a.to - a.from, v = b.to - b.from, between = b.from - a.from;
    const double square = normal.dot(u.cross(v));
    if (std::abs(square) < kAlong * u.norm() * v.norm()) return false;  // side by side
    const double s = normal.dot(between.cross(v)) / square, t = normal.dot(between.cross(u)) / square;
    if (!(s >= 0 && s <= 1 && t >= 0 && t <= 1)) return false;
    return std::abs(normal.dot(between + t * v - s * u)) < kAbove_mm;
}

std::optional<std::pair<std::size_t, std::size_t>> LineCrossing::first(bool closed) const {
    constexpr double kLoop_mm = 10;
    std::map<Cell, std::vector<std::size_t>> cells;  // of the pieces' middles
    const auto far_along = [&](const Piece& a, const Piece& b) {
        const double apart = std::abs(a.way_mm - b.way_mm);
        return std::min(apart, closed ? way_mm_ - apart : apart) > kLoop_mm;
    };
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
        const Piece& piece = pieces_[i];
        const Cell cell = cell_of((piece.from + piece.to) / 2);
        for (int n = 0; n < 27; ++n) {
            const auto found = cells.find({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
            if (found == cells.end()) continue;
            for (const std::size_t other : found->second)
                if (far_along(pieces_[other], piece) && cross(pieces_[other], piece))
                    return std::pair(pieces_[other].leg, piece.leg);
        }
        cells[cell].push_back(i);
    }
    return std::nullopt;
}

}  // namespace planlight
