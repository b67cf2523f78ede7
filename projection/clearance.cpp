#include "projection/clearance.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>

#include "planning_io/types/axes_along.h"
#include "projection/check_items.h"
#include "projection/skin_place.h"
#include "projection/skin_surface.h"
#include "projection/triangle_tree.h"

namespace planlight {
namespace {

using Eigen::Vector3d;
using triangle_tree::Kernel, triangle_tree::Primitive, triangle_tree::Tree, triangle_tree::Triangles;
using triangle_tree::to_cgal, triangle_tree::to_eigen;

constexpr double kTouches_mm = 1e-6;
constexpr double kRounding_mm = 1e-7;  // of a distance that is a round number

/// A convex solid of a plan item: a box of three half sizes (a plane's has no height, a way's is a line) about its
/// middle, or a cylinder about its third axis, grown by a radius all round.
struct Solid {
    Vector3d middle;
    Eigen::Matrix3d axes;  ///< columns, unit
    Vector3d half_mm;      ///< of the box; of a cylinder x is its radius
    bool round = false;    ///< a cylinder about its third axis
    double grown_mm = 0;

    /// Of a point to the solid; convex, and never steeper than the way of the point. 0 within.
    double distance_mm(const Vector3d& p) const {
        const Vector3d at = axes.transpose() * (p - middle);
        const double z = std::max(0.0, std::abs(at.z()) - half_mm.z());
        double aside = 0;
        if (round)
            aside = std::max(0.0, std::hypot(at.x(), at.y()) - half_mm.x());
        else
            aside = std::hypot(std::max(0.0, std::abs(at.x()) - half_mm.x()),
                               std::max(0.0, std::abs(at.y()) - half_mm.y()));
        return std::max(0.0, std::hypot(aside, z) - grown_mm);
    }
};

/// From a to b, with so much all round.
Solid way(const Vector3d& a, const Vector3d& b, double radius_mm) {
    const double length_mm = (b - a).norm();
    const Vector3d z = length_mm > 0 ? Vector3d((b - a) / length_mm) : Vector3d::UnitZ();
    return {(a + b) / 2, axes_along(z), {0, 0, length_mm / 2}, false, radius_mm};
}

std::vector<Solid> solids_of(const OsteotomyLine& line, const SkinSurface*) {
    std::vector<Solid> solids;
    const auto& p = line.points_in_ct;
    if (p.size() == 1) solids.push_back(way(p[0], p[0], 0));
    for (std::size_t i = 1; i < p.size(); ++i) solids.push_back(way(p[i - 1], p[i], 0));
    if (line.closed && p.size() > 2) solids.push_back(way(p.back(), p.front(), 0));
    return solids;
}

std::vector<Solid> solids_of(const Borehole& hole, const SkinSurface* skin) {
    if (!has_axis(hole) && !skin) return {};
    const Vector3d inwards = has_axis(hole) ? Vector3d(hole.axis_in_ct->normalized()) : drilling_direction(hole, *skin);
    const double depth_mm = std::max(hole.depth_mm, 0.0), radius_mm = std::max(hole.diameter_mm / 2, 0.0);
    return {{hole.position_in_ct + depth_mm / 2 * inwards,
             axes_along(inwards),
             {radius_mm, radius_mm, depth_mm / 2},
             true,
             0}};
}

std::vector<Solid> solids_of(const Trajectory& t, const SkinSurface*) {
    return {way(t.entry_in_ct, t.target_in_ct, std::max(t.diameter_mm / 2, 0.0))};
}

std::vector<Solid> solids_of(const CutPlane& plane, const SkinSurface*) {
    Eigen::Matrix3d axes;
    axes.col(0) = plane.first_axis_in_ct.normalized();
    axes.col(2) = (plane.normal_in_ct - plane.normal_in_ct.dot(axes.col(0)) * axes.col(0)).normalized();
    axes.col(1) = axes.col(2).cross(axes.col(0));
    if (!axes.allFinite() || !(axes.determinant() > 0.5)) return {};  // no plane
    return {{plane.origin_in_ct, axes, {plane.width_mm / 2, plane.height_mm / 2, 0}, false, 0}};
}

/// The smallest value of a convex function between 0 and `end` (golden section).
template <class Function>
double least_of(double end, const Function& f) {
    constexpr double kGolden = 0.6180339887498949;
    constexpr int kSteps = 48;  // to 1e-10 of the whole
    double low = 0, high = end, a = high - kGolden * (high - low), b = low + kGolden * (high - low);
    double at_a = f(a), at_b = f(b);
    for (int i = 0; i < kSteps && (at_a > 0 || at_b > 0); ++i) {
        if (at_a <= at_b) {
            high = b, b = a, at_b = at_a;
            at_a = f(a = high - kGolden * (high - low));
        } else {
            low = a, a = b, at_a = at_b;
            at_b = f(b = low + kGolden * (high - low));
        }
    }
    return std::min({at_a, at_b, f(low), f(high)});
}

/// The solid's distance is convex over the triangle: it is sought along one side, and for each place there across.
double distance_mm(const Solid& solid, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    return least_of(1, [&](double u) {
        const Vector3d from = a + u * (b - a);
        return least_of(1 - u, [&](double v) { return solid.distance_mm(from + v * (c - a)); });
    });
}

/// The triangle of a tree that is nearest to a solid: passes by all boxes and triangles that cannot be nearer.
class NearestTriangle {
public:
    using Priority = double;

    NearestTriangle(const Solid& solid, double nearest_mm) : solid_(solid), nearest_mm_(nearest_mm) {}

    bool go_further() const { return nearest_mm_ > 0; }
    template <class Node>
    bool do_intersect(int, const Node&) const {
        return true;
    }
    template <class Node>
    std::pair<bool, Priority> do_intersect_with_priority(int, const Node& node) const {
        const auto box = node.bbox();
        const Vector3d low(box.xmin(), box.ymin(), box.zmin()), high(box.xmax(), box.ymax(), box.zmax());
        const double at_least_mm = solid_.distance_mm((low + high) / 2) - (high - low).norm() / 2;
        return {at_least_mm < nearest_mm_, -at_least_mm};
    }
    void intersection(int, const Primitive& primitive) {
        const auto triangle = primitive.datum();
        const Vector3d a = to_eigen(triangle[0]), b = to_eigen(triangle[1]), c = to_eigen(triangle[2]),
                       middle = (a + b + c) / 3;
        const double around_mm = std::max({(a - middle).norm(), (b - middle).norm(), (c - middle).norm()});
        if (solid_.distance_mm(middle) - around_mm >= nearest_mm_) return;
        nearest_mm_ = std::min(nearest_mm_, distance_mm(solid_, a, b, c));
        if (nearest_mm_ < kTouches_mm) nearest_mm_ = 0;
    }
    double nearest_mm() const { return nearest_mm_; }

private:
    const Solid& solid_;
    double nearest_mm_;
};

/// Of each triangle a number that those have in common which hang together by corners.
std::vector<std::size_t> pieces_of(const TriangleMesh& surface) {
    std::vector<std::size_t> leader(surface.vertices_in_ct.size());
    std::iota(leader.begin(), leader.end(), std::size_t{0});
    const auto leader_of = [&](std::int32_t vertex) {
        auto v = static_cast<std::size_t>(vertex);
        while (leader[v] != v) v = leader[v] = leader[leader[v]];
        return v;
    };
    for (const auto& t : surface.triangles) {
        leader[leader_of(t[1])] = leader_of(t[0]);
        leader[leader_of(t[2])] = leader_of(t[0]);
    }
    std::vector<std::size_t> pieces;
    pieces.reserve(surface.triangles.size());
    for (const auto& t : surface.triangles) pieces.push_back(leader_of(t[0]));
    return pieces;
}

/// A risk structure that distances are measured to.
class RiskSurface {
public:
    explicit RiskSurface(const RiskStructure& structure)
        : name_(structure.name), piece_of_(pieces_of(structure.surface)) {
        const auto p = [&](std::int32_t i) {
            return to_cgal(structure.surface.vertices_in_ct[static_cast<std::size_t>(i)]);
        };
        for (const auto& t : structure.surface.triangles) triangles_.emplace_back(p(t[0]), p(t[1]), p(t[2]));
        tree_.rebuild(triangles_.cbegin(), triangles_.cend());
        tree_.do_not_accelerate_distance_queries();  // a search of its own follows
    }
    RiskSurface(const RiskSurface&) = delete;

    Clearance to(const std::vector<Solid>& solids) const {
        double nearest_mm = std::numeric_limits<double>::infinity();
        for (const Solid& solid : solids) {
            if (!std::isfinite(nearest_mm))  // a place to begin with
                nearest_mm = solid.distance_mm(to_eigen(tree_.closest_point(to_cgal(solid.middle))));
            NearestTriangle search(solid, nearest_mm < kTouches_mm ? 0 : nearest_mm);
            if (search.go_further()) tree_.traversal_with_priority(0, search);
            nearest_mm = search.nearest_mm();
            if (nearest_mm == 0) break;
        }
        // Where no solid meets the surface, all of them are joined and lie on one side of it.
        const bool through = nearest_mm == 0 || inside(solids.front().middle);
        return {name_, through ? 0 : nearest_mm, through};
    }
    bool empty() const { return triangles_.empty(); }

private:
    /// Within any of the structure's pieces, whatever others lie across it or round it: pieces overlap where models
    /// were merged, and a cavity is no way through. By three skew rays, so that one that grazes an edge is outvoted.
    bool inside(const Vector3d& p) const {
        std::map<std::size_t, int> votes;
        for (const Vector3d& way :
             {Vector3d(0.832, 0.413, 0.371), Vector3d(-0.297, 0.871, 0.391), Vector3d(0.179, -0.354, 0.918)}) {
            std::vector<Primitive::Id> met;
            tree_.all_intersected_primitives(Kernel::Ray_3(to_cgal(p), Kernel::Vector_3(way.x(), way.y(), way.z())),
                                             std::back_inserter(met));
            std::map<std::size_t, int> crossings;
            for (const auto& triangle : met)
                ++crossings[piece_of_[static_cast<std::size_t>(triangle - triangles_.cbegin())]];
            for (const auto& [piece, times] : crossings) votes[piece] += times % 2;
        }
        return std::any_of(votes.begin(), votes.end(), [](const auto& vote) { return vote.second >= 2; });
    }

    std::string name_;
    Triangles triangles_;
    std::vector<std::size_t> piece_of_;  ///< of each triangle: those that hang together by corners are one
    Tree tree_;
};

}  // namespace

std::vector<Clearances> clearances_of(const Plan& plan, const SkinSurface* skin) {
    std::vector<std::vector<Solid>> items;
    const auto add = [&](const auto& all) {
        for (const auto& item : all) items.push_back(finite(item) ? solids_of(item, skin) : std::vector<Solid>());
    };
    add(plan.osteotomy_lines), add(plan.boreholes), add(plan.trajectories), add(plan.cut_planes);
    std::vector<Clearances> clearances(items.size());
    for (const RiskStructure& structure : plan.risk_structures) {
        const RiskSurface surface(structure);  // one at a time: a large one takes some 200 MB
        if (surface.empty()) continue;
        for (std::size_t i = 0; i < items.size(); ++i)
            if (!items[i].empty()) clearances[i].push_back(surface.to(items[i]));
    }
    for (auto& of_item : clearances)
        std::stable_sort(of_item.begin(), of_item.end(), [](const Clearance& a, const Clearance& b) {
            return a.through != b.through ? a.through : a.mm < b.mm;
        });
    return clearances;
}

double said_mm(const Clearance& clearance) {
    return std::floor(10 * (clearance.mm + kRounding_mm)) / 10;
}

bool warns(const Clearance& clearance) {
    return clearance.through || said_mm(clearance) < kNearRisk_mm;
}

std::size_t warnings_in(const Clearances& clearances) {
    return static_cast<std::size_t>(std::count_if(clearances.begin(), clearances.end(), warns));
}

std::string clearance_in_words(const Clearance& clearance) {
    if (clearance.through) return "through " + clearance.structure;
    return fmt::format("{:.1f} mm to {}", said_mm(clearance), clearance.structure);
}

std::vector<std::string> risk_warnings(const std::string& item, const Clearances& clearances) {
    const std::string name = item.empty() ? "an item without a name" : item;
    std::vector<std::string> sentences;
    for (const Clearance& clearance : clearances) {
        if (!warns(clearance)) continue;
        sentences.push_back(clearance.through
                                ? fmt::format("{}: it goes through {}", name, clearance.structure)
                                : fmt::format("{}: it passes {:.1f} mm from {} (less than {:.0f} mm)", name,
                                              said_mm(clearance), clearance.structure, kNearRisk_mm));
    }
    return sentences;
}

}  // namespace planlight
