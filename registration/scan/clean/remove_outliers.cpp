#include "registration/scan/clean/remove_outliers.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include "registration/scan/clean/neighbour_kernel.h"
#include "registration/scan/clean/surface_grid.h"
#include "registration/scan/clean/voxel_downsample.h"

namespace planlight {
namespace {

using neighbour_kernel::Run;

enum class Fate : unsigned char { kept, jump, grazing, small_piece, lonely };

/// The points in the order of the grid, and what becomes of each.
struct Work {
    const Triangulation& raw;
    const OutlierSettings& settings;
    SurfaceGrid grid;
    Eigen::Vector3f light;        ///< where the projector stands, mm from `origin`
    Eigen::Vector3d origin;       ///< in rig: single precision is enough for differences from here
    std::vector<float> x, y, z;   ///< mm from `origin`; x is NaN where the point is removed for the later steps
    std::vector<float> reach_mm;  ///< how far two points of one surface in neighbouring cells may be apart
    std::vector<Fate> fate;
    std::vector<Eigen::Vector3f> normals;

    std::size_t size() const { return grid.order().size(); }
    Eigen::Vector3f point(std::size_t k) const { return {x[k], y[k], z[k]}; }
    neighbour_kernel::Coordinates coordinates() const { return {x.data(), y.data(), z.data()}; }
};

Work make_work(const Triangulation& raw, const RigCalibration& rig, const OutlierSettings& settings) {
    const Eigen::Vector3d light = rig.projector.centre_in_rig();
    Work work{raw, settings, SurfaceGrid(raw.grid), {}, Eigen::Vector3d::Zero(), {}, {}, {}, {}, {}, {}};
    const std::size_t n = work.size();
    if (n == 0) return work;
    work.origin = raw.cloud.points_in_rig[n / 2];
    work.light = (light - work.origin).cast<float>();
    for (auto* values : {&work.x, &work.y, &work.z, &work.reach_mm})
        values->resize(n + neighbour_kernel::kLanes, std::numeric_limits<float>::quiet_NaN());
    work.fate.resize(n, Fate::kept);
    work.normals.resize(n);
    const auto cell_by_distance = static_cast<float>(2 * work.grid.cell_px() / rig.projector.focal_x);
    const auto jump = static_cast<float>(settings.max_grid_jump_mm);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 4096), [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t k = range.begin(); k < range.end(); ++k) {
            const Eigen::Vector3f p = (raw.cloud.points_in_rig[work.grid.order()[k]] - work.origin).cast<float>();
            work.x[k] = p.x();
            work.y[k] = p.y();
            work.z[k] = p.z();
            work.reach_mm[k] = jump + cell_by_distance * (p - work.light).norm();  // the jump, and the cells themselves
        }
    });
    return work;
}

/// Calls `act(place, runs, state)` for every kept point, with the lines of cells within `Reach` of its own; bands of
/// lines in parallel, each with a state that `begin` makes and `end` gets.
template <int Reach, class Begin, class Act, class End>
void for_kept(const Work& work, const Begin& begin_band, const Act& act, const End& end_band) {
    tbb::parallel_for(tbb::blocked_range<int>(0, work.grid.rows(), 8), [&](const tbb::blocked_range<int>& range) {
        auto state = begin_band();
        for (int row = range.begin(); row < range.end(); ++row)
            for (int column = 0; column < work.grid.columns(); ++column) {
                const auto [begin, end] = work.grid.in_cells(row, column, 0);
                if (begin == end) continue;
                std::array<Run, 2 * Reach + 1> runs;
                for (int dy = -Reach; dy <= Reach; ++dy) {
                    const auto [first, last] = work.grid.in_cells(row + dy, column, Reach);
                    runs[static_cast<std::size_t>(dy + Reach)] = {first, last};
                }
                for (std::uint32_t k = begin; k < end; ++k)
                    if (work.fate[k] == Fate::kept) act(k, runs, state);
            }
        end_band(state);
    });
}

void forget_removed(Work& work) {
    for (std::size_t k = 0; k < work.size(); ++k)
        if (work.fate[k] != Fate::kept) work.x[k] = std::numeric_limits<float>::quiet_NaN();
}

/// A point most of whose neighbours stand elsewhere in depth is no surface; one without neighbours neither.
void mark_jumps_and_lonely(Work& work) {
    const auto nothing = [](auto&&...) { return 0; };
    const auto judge = [&](std::uint32_t k, const std::array<Run, 3>& runs, int) {
        int all = -1;  // without itself
        for (const Run& run : runs) all += static_cast<int>(run.end - run.begin);
        const int near = neighbour_kernel::count_within(work.coordinates(), runs.data(), 3, k, work.reach_mm[k]) - 1;
        if (all < 2)
            work.fate[k] = Fate::lonely;
        else if (near < 2 || 7 * near < 3 * all)
            work.fate[k] = Fate::jump;
    };
    for_kept<1>(work, nothing, judge, nothing);
    forget_removed(work);
}

/// Points whose planes are asked for together.
struct Batch {
    int count = 0;
    std::array<std::uint32_t, neighbour_kernel::kPlanes> place;
    neighbour_kernel::Planes planes{};
};

/// Their normals, towards the projector; steep points and those without a plane are marked.
void judge_planes(Batch& batch, float least_cosine, Work& work) {
    neighbour_kernel::find_planes(batch.planes);
    for (int i = 0; i < batch.count; ++i) {
        const std::uint32_t k = batch.place[static_cast<std::size_t>(i)];
        const Eigen::Vector3f normal(batch.planes.normal_x[i], batch.planes.normal_y[i], batch.planes.normal_z[i]);
        const float cosine = normal.dot((work.light - work.point(k)).normalized());
        work.normals[k] = cosine < 0 ? Eigen::Vector3f(-normal) : normal;
        if (normal.isZero())
            work.fate[k] = Fate::lonely;
        else if (std::abs(cosine) < least_cosine)
            work.fate[k] = Fate::grazing;
    }
    batch.count = 0;
}

/// Normals of the planes through the neighbours.
void find_normals(Work& work) {
    const auto least_cosine = static_cast<float>(std::cos(work.settings.max_grazing_angle));
    for_kept<2>(
        work, [] { return std::make_unique<Batch>(); },
        [&](std::uint32_t k, const std::array<Run, 5>& runs, const std::unique_ptr<Batch>& batch) {
            batch->place[static_cast<std::size_t>(batch->count)] = k;
            batch->planes.set(batch->count++, neighbour_kernel::sum_within(work.coordinates(), runs.data(), 5, k,
                                                                           2 * work.reach_mm[k]));
            if (batch->count == neighbour_kernel::kPlanes) judge_planes(*batch, least_cosine, work);
        },
        [&](const std::unique_ptr<Batch>& batch) { judge_planes(*batch, least_cosine, work); });
    forget_removed(work);
}

using Parents = std::vector<std::uint32_t>;

std::uint32_t root_of(Parents& parent, std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/// Joins the points of a line of cells with each other (`down` false) or with those of the next line.
void join_line(const Work& work, int row, bool down, Parents& parent) {
    for (int column = 0; column < work.grid.columns(); ++column) {
        const auto [begin, end] = work.grid.in_cells(row, column, 0);
        const auto [first, last] = down ? work.grid.in_cells(row + 1, column, 1) : work.grid.in_cells(row, column, 1);
        for (std::uint32_t k = begin; k < end; ++k) {
            if (work.fate[k] != Fate::kept) continue;
            const float reach_squared = work.reach_mm[k] * work.reach_mm[k];
            std::uint32_t root = root_of(parent, k);
            for (std::uint32_t j = down ? first : k + 1; j < last; ++j) {
                if (parent[j] == root || !((work.point(j) - work.point(k)).squaredNorm() <= reach_squared)) continue;
                parent[root_of(parent, j)] = root;
            }
        }
    }
}

/// Connected pieces over the links between neighbouring cells: bands of lines in parallel, then across their borders.
Parents find_pieces(const Work& work) {
    constexpr int kBand = 32;
    Parents parent(work.size());
    std::iota(parent.begin(), parent.end(), 0u);
    const int rows = work.grid.rows(), bands = (rows + kBand - 1) / kBand;
    tbb::parallel_for(0, bands, [&](int band) {
        const int end = std::min(rows, (band + 1) * kBand);
        for (int row = band * kBand; row < end; ++row) {
            join_line(work, row, false, parent);
            if (row + 1 < end) join_line(work, row, true, parent);
        }
    });
    for (int band = 1; band < bands; ++band) join_line(work, band * kBand - 1, true, parent);
    return parent;
}

void mark_small_pieces(Work& work) {
    Parents parent = find_pieces(work);
    std::vector<std::size_t> count(work.size(), 0);
    std::size_t largest = 0;
    for (std::uint32_t k = 0; k < work.size(); ++k)
        if (work.fate[k] == Fate::kept) largest = std::max(largest, ++count[root_of(parent, k)]);
    const double needed = std::max<double>(work.settings.min_piece_points,
                                           work.settings.min_piece_fraction * static_cast<double>(largest));
    for (std::uint32_t k = 0; k < work.size(); ++k)
        if (work.fate[k] == Fate::kept && static_cast<double>(count[root_of(parent, k)]) < needed)
            work.fate[k] = Fate::small_piece;
}

void keep(const Work& work, OutlierReport& report) {
    std::array<std::size_t, 5> count{};
    std::vector<std::uint32_t> left_over;  // places in the grid's order
    for (std::uint32_t k = 0; k < work.size(); ++k) {
        ++count[static_cast<std::size_t>(work.fate[k])];
        if (work.fate[k] == Fate::kept) left_over.push_back(k);
    }
    report.jump = count[static_cast<std::size_t>(Fate::jump)];
    report.grazing = count[static_cast<std::size_t>(Fate::grazing)];
    report.small_piece = count[static_cast<std::size_t>(Fate::small_piece)];
    report.lonely = count[static_cast<std::size_t>(Fate::lonely)];
    std::vector<Eigen::Vector3f> points(left_over.size());
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = work.point(left_over[i]);
    const std::size_t limit =
        work.settings.max_points > 0 ? static_cast<std::size_t>(work.settings.max_points) : points.size();
    std::vector<std::size_t> chosen = voxel_downsample(points, limit);
    report.thinned = points.size() - chosen.size();
    const PointCloud& raw = work.raw.cloud;
    PointCloud& kept = report.kept;
    kept.points_in_rig.resize(chosen.size());
    kept.normals_in_rig.resize(chosen.size());
    kept.sigma_mm.resize(chosen.size());
    kept.pixels_in_projector.resize(chosen.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, chosen.size(), 4096),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t i = range.begin(); i < range.end(); ++i) {
                              const std::uint32_t k = left_over[chosen[i]], original = work.grid.order()[k];
                              kept.points_in_rig[i] = raw.points_in_rig[original];
                              kept.normals_in_rig[i] = work.normals[k].cast<double>().normalized();
                              kept.sigma_mm[i] = raw.sigma_mm[original];
                              kept.pixels_in_projector[i] = raw.pixels_in_projector[original];
                          }
                      });
}

}  // namespace

OutlierReport remove_outliers(const Triangulation& raw, const RigCalibration& rig, const OutlierSettings& settings) {
    Work work = make_work(raw, rig, settings);
    mark_jumps_and_lonely(work);
    find_normals(work);
    mark_small_pieces(work);
    OutlierReport report;
    keep(work, report);
    return report;
}

}  // namespace planlight
