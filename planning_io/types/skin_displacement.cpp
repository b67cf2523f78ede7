#include "planning_io/types/skin_displacement.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <unordered_map>
#include <vector>

#include "planning_io/types/statistics.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kNeighbours = 20;

void check(const SkinDisplacement& d) {
    bool good = std::isfinite(d.offset_mm);
    if (d.known())
        good = good && d.apart_mm > 0 && d.alike_over_mm > 0 && d.spread_mm > 0 && std::isfinite(d.spread_mm);
    for (const auto& place : d.places)
        good = good && place.p_in_ct.allFinite() && std::isfinite(place.mm) && place.sigma_mm > 0;
    if (!good) throw std::invalid_argument("the displacement of the skin holds a number that cannot be");
}

}  // namespace

double spread_of_skin_mm(const SkinDisplacement& displacement) {
    if (!displacement.known()) return 0;
    std::vector<double> noise_mm2;
    for (const auto& place : displacement.places) noise_mm2.push_back(place.sigma_mm * place.sigma_mm);
    return std::sqrt(std::max(0.0, displacement.spread_mm * displacement.spread_mm - median(std::move(noise_mm2))));
}

std::optional<double> covered_by_mm(const SkinDisplacement& displacement, const Eigen::Vector3d& p_in_ct) {
    const double reach_mm = 1.5 * displacement.apart_mm;
    double nearest = reach_mm * reach_mm;
    std::optional<double> mm;
    for (const auto& cover : displacement.covered)
        if (const double square = (cover.p_in_ct - p_in_ct).squaredNorm(); square < nearest)
            nearest = square, mm = cover.mm;
    if (!mm) return std::nullopt;
    for (const auto& place : displacement.places)  // of a swelling there is a place where it is covered
        if ((place.p_in_ct - p_in_ct).squaredNorm() < nearest) return std::nullopt;
    return mm;
}

struct SkinDisplacementField::Parts {
    using Near = std::pair<double, const SkinDisplacement::Place*>;  // squared distance, mm^2

    explicit Parts(SkinDisplacement d) : displacement(std::move(d)) {
        check(displacement);
        if (!displacement.known()) return;
        fine.cell_mm = 2 * displacement.apart_mm;
        coarse.cell_mm = std::max(fine.cell_mm, 0.5 * displacement.alike_over_mm);
        for (const auto& place : displacement.places) fine.add(place);
        // Off the scan a few places tell as much as all.
        std::unordered_map<std::uint64_t, bool> occupied;
        for (const auto& place : displacement.places)
            if (occupied.emplace(coarse.key(coarse.cell_of(place.p_in_ct)), true).second) coarse.add(place);
    }

    struct Grid {
        double cell_mm = 1;
        std::unordered_map<std::uint64_t, std::vector<const SkinDisplacement::Place*>> cells;

        Eigen::Vector3i cell_of(const Vector3d& p) const {
            return (p / cell_mm).array().max(-1e6).min(1e6).floor().cast<int>();
        }
        static std::uint64_t key(const Eigen::Vector3i& c) {
            const auto part = [](int i) { return static_cast<std::uint64_t>(i + (1 << 20)) & 0x1fffff; };
            return part(c.x()) | (part(c.y()) << 21) | (part(c.z()) << 42);
        }
        void add(const SkinDisplacement::Place& place) { cells[key(cell_of(place.p_in_ct))].push_back(&place); }
        void gather(const Vector3d& p, int reach, std::vector<Near>& near) const {
            near.clear();
            const Eigen::Vector3i at = cell_of(p);
            for (int z = -reach; z <= reach; ++z)
                for (int y = -reach; y <= reach; ++y)
                    for (int x = -reach; x <= reach; ++x) {
                        const auto found = cells.find(key(at + Eigen::Vector3i(x, y, z)));
                        if (found == cells.end()) continue;
                        for (const auto* place : found->second)
                            near.emplace_back((place->p_in_ct - p).squaredNorm(), place);
                    }
        }
    };

    Value krige(const Vector3d& p, std::vector<Near>& near) const;

    SkinDisplacement displacement;
    Grid fine, coarse;
};

SkinDisplacementField::Value SkinDisplacementField::Parts::krige(const Vector3d& p, std::vector<Near>& near) const {
    const std::size_t count = std::min(kNeighbours, near.size());
    std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
    const double variance = displacement.spread_mm * displacement.spread_mm;
    const auto kernel = [&](const Vector3d& a, const Vector3d& b) {
        return variance * std::exp(-(a - b).norm() / displacement.alike_over_mm);
    };
    const auto n = static_cast<Eigen::Index>(count);
    using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kNeighbours, kNeighbours>;
    using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kNeighbours, 1>;
    Square K(n, n);
    Column k(n), above(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto& a = *near[static_cast<std::size_t>(i)].second;
        for (Eigen::Index j = 0; j <= i; ++j)
            K(i, j) = K(j, i) = kernel(a.p_in_ct, near[static_cast<std::size_t>(j)].second->p_in_ct);
        K(i, i) += a.sigma_mm * a.sigma_mm;
        k[i] = kernel(a.p_in_ct, p);
        above[i] = a.mm - displacement.offset_mm;
    }
    const Column weights = Eigen::LLT<Square>(K).solve(k);
    Value value;
    value.mm = displacement.offset_mm + weights.dot(above);
    value.sigma_mm = std::sqrt(std::max(0., variance - weights.dot(k)));
    value.scanned = count > 0 && near.front().first < 4 * displacement.apart_mm * displacement.apart_mm;
    return value;
}

SkinDisplacementField::SkinDisplacementField(SkinDisplacement displacement)
    : parts_(std::make_unique<Parts>(std::move(displacement))) {}
SkinDisplacementField::~SkinDisplacementField() = default;
SkinDisplacementField::SkinDisplacementField(SkinDisplacementField&&) noexcept = default;
SkinDisplacementField& SkinDisplacementField::operator=(SkinDisplacementField&&) noexcept = default;

SkinDisplacementField::Value SkinDisplacementField::at(const Vector3d& p_in_ct) const {
    if (!parts_->displacement.known()) return {parts_->displacement.offset_mm, 0, false};
    thread_local std::vector<Parts::Near> near;
    parts_->fine.gather(p_in_ct, 1, near);
    if (near.size() < kNeighbours / 2) parts_->coarse.gather(p_in_ct, 4, near);
    return parts_->krige(p_in_ct, near);
}

const SkinDisplacement& SkinDisplacementField::displacement() const {
    return parts_->displacement;
}

}  // namespace planlight
