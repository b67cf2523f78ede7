#include "planning_io/surface/contour_solid.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "planning_io/surface/mask_surface.h"
#include "planning_io/types/axes_along.h"
#include "planning_io/types/error.h"
#include "planning_io/types/statistics.h"

namespace planlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kOneHeight_mm = 0.1, kMostAcross_mm = 1000;
constexpr double kBridged = 3;  // usual gaps
constexpr double kPixel_mm = 0.25, kCoarser = 1.15, kLayersOfSlice = 3;
constexpr double kMostVoxels = 8e6;
constexpr int kMargin = 3;        // pixels round a contour
constexpr double kWithin = 0.98;  // of the area of what it lies within
constexpr const char* kExportAgain = "Export the ROI with contours on every slice of one series.";

/// One contour in axes of its own: z across it.
struct Contour {
    std::vector<Vector2d> points;
    double height = 0, area = 0;  ///< area: mm^2
    Vector2d low, high;
    double from = 0, to = 0;  ///< heights that it fills
    int part = 0;

    bool overlaps(const Contour& other) const {
        return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
    }
    bool holds(const Vector2d& p) const {
        bool inside = false;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Vector2d &a = points[i], &b = points[(i + 1) % points.size()];
            if ((a.y() <= p.y()) == (b.y() <= p.y())) continue;
            inside ^= p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
        }
        return inside;
    }
    bool lies_within(const Contour& other) const {
        return area < kWithin * other.area &&
               std::all_of(points.begin(), points.end(), [&](const Vector2d& p) { return other.holds(p); });
    }
};

Contour contour_of(const std::vector<Vector3d>& loop, const Eigen::Matrix3d& axes) {
    Contour contour;
    contour.low = Vector2d::Constant(INFINITY), contour.high = -contour.low;
    double least = INFINITY, most = -INFINITY, twice = 0;
    for (const Vector3d& in_ct : loop) {
        const Vector3d p = axes.transpose() * in_ct;
        contour.points.emplace_back(p.head<2>());
        contour.low = contour.low.cwiseMin(p.head<2>());
        contour.high = contour.high.cwiseMax(p.head<2>());
        least = std::min(least, p.z());
        most = std::max(most, p.z());
    }
    for (std::size_t i = 0; i < contour.points.size(); ++i) {
        const Vector2d &a = contour.points[i], &b = contour.points[(i + 1) % contour.points.size()];
        twice += a.x() * b.y() - a.y() * b.x();
    }
    contour.area = std::abs(twice) / 2;
    contour.height = most - least < kOneHeight_mm ? (least + most) / 2 : NAN;
    return contour;
}

/// The usual gap between slices; says which gaps are so wide that nothing is drawn in them. 0 where there is none.
double usual_gap(const std::vector<Contour>& contours, const std::string& name, std::vector<std::string>& notes) {
    std::vector<double> gaps;
    for (std::size_t i = 1; i < contours.size(); ++i)
        if (const double gap = contours[i].height - contours[i - 1].height; gap > kOneHeight_mm) gaps.push_back(gap);
    if (gaps.empty()) return 0;
    const double usual = median(gaps), widest = *std::max_element(gaps.begin(), gaps.end());
    if (widest > kBridged * usual)
        notes.push_back(
            fmt::format("ROI \"{}\" has no contour over {:.1f} mm, where others lie {:.1f} mm apart: it is taken "
                        "for empty",
                        name, widest, usual));
    return usual;
}

int root_of(std::vector<int>& parent, int i) {
    while (parent[static_cast<std::size_t>(i)] != i) i = parent[static_cast<std::size_t>(i)];
    return i;
}

/// Which heights each contour fills, and which connected part it is of. By height, the lowest first.
void connect(std::vector<Contour>& contours, double usual) {
    const auto count = static_cast<int>(contours.size());
    std::vector<int> parent(contours.size());
    std::iota(parent.begin(), parent.end(), 0);
    for (int i = 0; i < count; ++i) {
        Contour& contour = contours[static_cast<std::size_t>(i)];
        contour.from = contour.height - usual / 2;
        contour.to = contour.height + usual / 2;
        for (const int way : {1, -1}) {
            double nearest = INFINITY;
            for (int k = i + way; k >= 0 && k < count; k += way) {
                const Contour& other = contours[static_cast<std::size_t>(k)];
                const double gap = std::abs(other.height - contour.height);
                if (gap > std::min(kBridged * usual, nearest) + kOneHeight_mm) break;
                if (!contour.overlaps(other)) continue;
                parent[static_cast<std::size_t>(root_of(parent, k))] = root_of(parent, i);
                if (gap > kOneHeight_mm) nearest = std::min(nearest, gap);
            }
            if (std::isfinite(nearest)) (way > 0 ? contour.to : contour.from) = contour.height + way * nearest / 2;
        }
    }
    for (int i = 0; i < count; ++i) contours[static_cast<std::size_t>(i)].part = root_of(parent, i);
}

/// Pixels of one slice.
struct Bitmap {
    int columns = 0, rows = 0;
    std::vector<std::uint8_t> marked;
    Bitmap(int c, int r) : columns(c), rows(r), marked(static_cast<std::size_t>(c) * static_cast<std::size_t>(r), 0) {}
    std::uint8_t& at(int x, int y) {
        return marked[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(x)];
    }
    std::uint8_t at(int x, int y) const {
        return x < 0 || y < 0 || x >= columns || y >= rows
                   ? std::uint8_t{0}
                   : marked[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) +
                            static_cast<std::size_t>(x)];
    }
    /// Marked where all (or any) pixels within `reach` along both axes are.
    Bitmap filtered(int reach, bool all) const { return along(reach, all, 1, 0).along(reach, all, 0, 1); }

private:
    Bitmap along(int reach, bool all, int dx, int dy) const {
        Bitmap out(columns, rows);
        for (int y = 0; y < rows; ++y)
            for (int x = 0; x < columns; ++x) {
                int count = 0;
                for (int k = -reach; k <= reach; ++k) count += at(x + k * dx, y + k * dy);
                out.at(x, y) = (all ? count == 2 * reach + 1 : count > 0) ? 1 : 0;
            }
        return out;
    }
};

/// The contour's pixels: centres within it, and of what is thinner than three pixels all that it touches, three wide.
/// `low`: the place of the first pixel.
Bitmap drawn(const Contour& contour, const Vector2d& low, double pixel_mm) {
    const Vector2d wide = (contour.high - low) / pixel_mm;
    const int columns = static_cast<int>(wide.x()) + kMargin + 1, rows = static_cast<int>(wide.y()) + kMargin + 1;
    Bitmap inside(columns, rows);
    const std::size_t n = contour.points.size();
    for (int j = 0; j < rows; ++j) {
        const double y = low.y() + pixel_mm * j;
        std::vector<double> crossings;
        for (std::size_t i = 0; i < n; ++i) {
            const Vector2d &a = contour.points[i], &b = contour.points[(i + 1) % n];
            if ((a.y() <= y) == (b.y() <= y)) continue;
            crossings.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
        }
        std::sort(crossings.begin(), crossings.end());
        for (std::size_t c = 0; c + 1 < crossings.size(); c += 2)
            for (int i = std::max(0, static_cast<int>(std::ceil((crossings[c] - low.x()) / pixel_mm)));
                 i < columns && low.x() + pixel_mm * i < crossings[c + 1]; ++i)
                inside.at(i, j) = 1;
    }
    const Bitmap thick = inside.filtered(1, true).filtered(1, false), near_thick = thick.filtered(2, false);
    Bitmap touched = inside;
    for (std::size_t i = 0; i < n; ++i) {
        const Vector2d &a = contour.points[i], &b = contour.points[(i + 1) % n];
        const int steps = 1 + static_cast<int>((b - a).norm() / (pixel_mm / 2));
        for (int s = 0; s < steps; ++s) {
            const Vector2d p = (a + (b - a) * s / steps - low) / pixel_mm;
            const auto x = static_cast<int>(std::lround(p.x())), y = static_cast<int>(std::lround(p.y()));
            if (x >= 0 && y >= 0 && x < columns && y < rows) touched.at(x, y) = 1;
        }
    }
    for (std::size_t i = 0; i < touched.marked.size(); ++i) {
        inside.marked[i] |= touched.marked[i];  // never smaller than it was outlined
        if (near_thick.marked[i]) touched.marked[i] = 0;
    }
    const Bitmap thin = touched.filtered(1, false);
    for (std::size_t i = 0; i < thin.marked.size(); ++i) inside.marked[i] |= thin.marked[i];
    return inside;
}

/// The contours, outer ones first, with how deep each lies in others of its height, within each other in turn: a hole
/// where it is odd. Two of the same outline are one.
std::vector<std::pair<int, const Contour*>> by_depth(const std::vector<Contour>& part) {
    std::vector<std::pair<int, const Contour*>> sorted;
    for (const Contour& contour : part) sorted.emplace_back(0, &contour);
    const auto larger = [](const auto& a, const auto& b) { return a.second->area > b.second->area; };
    std::stable_sort(sorted.begin(), sorted.end(), larger);
    for (std::size_t i = 0; i < sorted.size(); ++i)
        for (std::size_t k = 0; k < i; ++k) {
            const Contour &inner = *sorted[i].second, &outer = *sorted[k].second;
            if (std::abs(outer.height - inner.height) < kOneHeight_mm && outer.overlaps(inner) &&
                inner.lies_within(outer))
                sorted[i].first = std::max(sorted[i].first, sorted[k].first + 1);
        }
    std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    return sorted;
}

MaskStack mask_of(const std::vector<Contour>& part, const Eigen::Matrix3d& axes) {
    Vector3d low = Vector3d::Constant(INFINITY), high = -low;
    double thinnest = INFINITY;
    for (const Contour& c : part) {
        low = low.cwiseMin(Vector3d(c.low.x(), c.low.y(), c.from));
        high = high.cwiseMax(Vector3d(c.high.x(), c.high.y(), c.to));
        thinnest = std::min(thinnest, c.to - c.from);
    }
    double pixel_mm = kPixel_mm, layer_mm = 0;
    MaskStack mask;
    for (;; pixel_mm *= kCoarser) {
        layer_mm = std::min(pixel_mm, thinnest / kLayersOfSlice);
        const Vector3d voxels = (high - low).cwiseQuotient(Vector3d(pixel_mm, pixel_mm, layer_mm));
        for (int a = 0; a < 2; ++a) mask.size[static_cast<std::size_t>(a)] = static_cast<int>(voxels[a]) + 2 * kMargin;
        mask.size[2] = std::max(1, static_cast<int>(std::lround(voxels.z())));
        if ((voxels.array() + 2 * kMargin).prod() < kMostVoxels) break;
    }
    const Vector3d first(low.x() - kMargin * pixel_mm, low.y() - kMargin * pixel_mm, low.z() + layer_mm / 2);
    mask.ct_from_voxel.linear() = axes * Vector3d(pixel_mm, pixel_mm, layer_mm).asDiagonal();
    mask.ct_from_voxel.translation() = axes * first;
    const std::size_t slab = static_cast<std::size_t>(mask.size[0]) * static_cast<std::size_t>(mask.size[1]);
    mask.inside.assign(slab * static_cast<std::size_t>(mask.size[2]), 0);
    for (const auto& [depth, contour] : by_depth(part)) {
        const Vector2d from = (contour->low - first.head<2>()) / pixel_mm;
        const int x0 = static_cast<int>(from.x()) - kMargin, y0 = static_cast<int>(from.y()) - kMargin;
        const Bitmap pixels = drawn(*contour, first.head<2>() + pixel_mm * Vector2d(x0, y0), pixel_mm);
        for (int k = 0; k < mask.size[2]; ++k) {
            const double height = first.z() + layer_mm * k;
            if (height < contour->from || height > contour->to) continue;
            std::uint8_t* layer = mask.inside.data() + static_cast<std::size_t>(k) * slab;
            for (int y = 0; y < pixels.rows; ++y)
                for (int x = 0; x < pixels.columns; ++x) {
                    const int column = x + x0, row = y + y0;
                    if (pixels.at(x, y) == 0 || column < 0 || row < 0 || column >= mask.size[0] || row >= mask.size[1])
                        continue;
                    layer[static_cast<std::size_t>(row) * static_cast<std::size_t>(mask.size[0]) +
                          static_cast<std::size_t>(column)] = depth % 2 == 0 ? 1 : 0;
                }
        }
    }
    return mask;
}

}  // namespace

Eigen::Matrix3d axes_of_contours(const std::vector<std::vector<Vector3d>>& loops) {
    for (const auto& loop : loops) {
        Vector3d area = Vector3d::Zero();
        for (std::size_t i = 0; i < loop.size(); ++i)
            area += (loop[i] - loop[0]).cross(loop[(i + 1) % loop.size()] - loop[0]);
        if (area.norm() > 1e-6) return axes_along(area.normalized());
    }
    return Eigen::Matrix3d::Identity();
}

TriangleMesh contour_solid(std::vector<std::vector<Vector3d>> loops, const std::string& name,
                           const std::filesystem::path& file, std::vector<std::string>& notes) {
    const Eigen::Matrix3d axes = axes_of_contours(loops);
    std::vector<Contour> contours;
    Vector2d low = Vector2d::Constant(INFINITY), high = -low;
    for (const auto& loop : loops) {
        contours.push_back(contour_of(loop, axes));
        if (std::isnan(contours.back().height))
            throw InputError(file, "ROI \"" + name + "\" has contours that are not parallel", kExportAgain);
        low = low.cwiseMin(contours.back().low);
        high = high.cwiseMax(contours.back().high);
    }
    std::sort(contours.begin(), contours.end(), [](const Contour& a, const Contour& b) { return a.height < b.height; });
    const double across = std::max((high - low).maxCoeff(), contours.back().height - contours.front().height);
    if (!(across < kMostAcross_mm))
        throw InputError(file, fmt::format("ROI \"{}\" is {:.0f} mm across", name, across), kExportAgain);
    const double usual = usual_gap(contours, name, notes);
    if (!(usual > 0)) throw InputError(file, "ROI \"" + name + "\" has all its contours at one height", kExportAgain);
    connect(contours, usual);
    std::stable_sort(contours.begin(), contours.end(),
                     [](const Contour& a, const Contour& b) { return a.part < b.part; });
    TriangleMesh solid;
    for (std::size_t from = 0, to = 0; from < contours.size(); from = to) {
        while (to < contours.size() && contours[to].part == contours[from].part) ++to;
        const TriangleMesh part = surface_of_mask(mask_of(
            {contours.begin() + static_cast<std::ptrdiff_t>(from), contours.begin() + static_cast<std::ptrdiff_t>(to)},
            axes));
        const auto before = static_cast<std::int32_t>(solid.vertices_in_ct.size());
        solid.vertices_in_ct.insert(solid.vertices_in_ct.end(), part.vertices_in_ct.begin(), part.vertices_in_ct.end());
        for (const auto& t : part.triangles) solid.triangles.push_back({t[0] + before, t[1] + before, t[2] + before});
    }
    return solid;
}

}  // namespace planlight
