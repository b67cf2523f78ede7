#include "registration/scan/remove_outliers.h"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numeric>

#include "registration/scan/surface_grid.h"
#include "registration/scan/thin_points.h"

namespace planlight {
namespace {

enum class Fate : unsigned char { kept, jump, grazing, small_piece, lonely };

struct Work {
    const Triangulation& raw;
    const RigCalibration& rig;
    const OutlierSettings& settings;
    Eigen::Vector3d light_in_rig;   ///< where the projector stands
    SurfaceGrid grid;
    std::vector<Fate> fate;
    std::vector<Eigen::Vector3d> normals;

    std::size_t size() const { return raw.cloud.size(); }
    const Eigen::Vector3d& point(std::size_t i) const { return raw.cloud.points_in_rig[i]; }

    /// How far two points of one surface in neighbouring cells may be apart, mm: the jump, and the cells themselves.
    double reach_mm(std::size_t i) const {
        const double cell_mm = grid.cell_px() * (point(i) - light_in_rig).norm() / rig.projector.focal_x;
        return settings.max_grid_jump_mm + 2 * cell_mm;
    }
    bool linked(std::size_t i, std::size_t j) const {
        const double reach = reach_mm(i);
        return (point(i) - point(j)).squaredNorm() <= reach * reach;
    }
};

template <class Do>
void for_kept(const Work& work, const Do& act) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, work.size(), 1024), [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i)
            if (work.fate[i] == Fate::kept) act(i);
    });
}

/// A point most of whose neighbours stand elsewhere in depth is no surface; one without neighbours neither.
void mark_jumps_and_lonely(Work& work) {
    for_kept(work, [&](std::size_t i) {
        int near = 0, far = 0;
        work.grid.neighbours(i, 1, [&](std::size_t j) { ++(work.linked(i, j) ? near : far); });
        if (near + far < 2) work.fate[i] = Fate::lonely;
        else if (near < 2 || 7 * near < 3 * (near + far)) work.fate[i] = Fate::jump;
    });
}

std::size_t root_of(std::vector<std::size_t>& parent, std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/// Connected pieces over the links between neighbouring cells.
void mark_small_pieces(Work& work) {
    std::vector<std::size_t> parent(work.size()), count(work.size(), 0);
    std::iota(parent.begin(), parent.end(), std::size_t{0});
    for (std::size_t i = 0; i < work.size(); ++i) {
        if (work.fate[i] != Fate::kept) continue;
        work.grid.neighbours(i, 1, [&](std::size_t j) {
            if (j < i || work.fate[j] != Fate::kept || !work.linked(i, j)) return;
            parent[root_of(parent, i)] = root_of(parent, j);
        });
    }
    std::size_t largest = 0;
    for (std::size_t i = 0; i < work.size(); ++i)
        if (work.fate[i] == Fate::kept) largest = std::max(largest, ++count[root_of(parent, i)]);
    const double needed = std::max<double>(work.settings.min_piece_points,
                                           work.settings.min_piece_fraction * static_cast<double>(largest));
    for (std::size_t i = 0; i < work.size(); ++i)
        if (work.fate[i] == Fate::kept && static_cast<double>(count[root_of(parent, i)]) < needed)
            work.fate[i] = Fate::small_piece;
}

/// The normal of the plane through the neighbours, towards the projector; zero when they do not span one.
Eigen::Vector3d normal_at(const Work& work, std::size_t i) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    int n = 1;
    const double reach = 2 * work.reach_mm(i);
    work.grid.neighbours(i, 2, [&](std::size_t j) {
        const Eigen::Vector3d d = work.point(j) - work.point(i);
        if (work.fate[j] != Fate::kept || d.squaredNorm() > reach * reach) return;
        ++n;
        sum += d;
        squares += d * d.transpose();
    });
    if (n < 6) return Eigen::Vector3d::Zero();
    squares -= sum * sum.transpose() / n;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(squares);
    if (!(solver.eigenvalues()(1) > 1e-6 * solver.eigenvalues()(2))) return Eigen::Vector3d::Zero();
    const Eigen::Vector3d normal = solver.eigenvectors().col(0).normalized();
    return normal.dot(work.light_in_rig - work.point(i)) < 0 ? Eigen::Vector3d(-normal) : normal;
}

void find_normals(Work& work) {
    for_kept(work, [&](std::size_t i) { work.normals[i] = normal_at(work, i); });
    const double least_cosine = std::cos(work.settings.max_grazing_angle);
    for_kept(work, [&](std::size_t i) {
        const Eigen::Vector3d& normal = work.normals[i];
        if (normal.isZero()) work.fate[i] = Fate::lonely;
        else if (normal.dot((work.light_in_rig - work.point(i)).normalized()) < least_cosine) work.fate[i] = Fate::grazing;
    });
}

void keep(const Work& work, OutlierReport& report) {
    std::vector<std::size_t> left_over;
    std::vector<Eigen::Vector3d> points;
    for (std::size_t i = 0; i < work.size(); ++i) {
        if (work.fate[i] == Fate::jump) ++report.jump;
        if (work.fate[i] == Fate::grazing) ++report.grazing;
        if (work.fate[i] == Fate::small_piece) ++report.small_piece;
        if (work.fate[i] == Fate::lonely) ++report.lonely;
        if (work.fate[i] != Fate::kept) continue;
        left_over.push_back(i);
        points.push_back(work.point(i));
    }
    const std::size_t limit = work.settings.max_points > 0 ? static_cast<std::size_t>(work.settings.max_points) : points.size();
    for (const std::size_t k : thin_evenly(points, limit)) {
        const std::size_t i = left_over[k];
        report.kept.points_in_rig.push_back(work.point(i));
        report.kept.normals_in_rig.push_back(work.normals[i]);
        report.kept.sigma_mm.push_back(work.raw.cloud.sigma_mm[i]);
        report.kept.pixels_in_projector.push_back(work.raw.cloud.pixels_in_projector[i]);
    }
    report.thinned = points.size() - report.kept.size();
}

}  // namespace

OutlierReport remove_outliers(const Triangulation& raw, const RigCalibration& rig, const OutlierSettings& settings) {
    Work work{raw,
              rig,
              settings,
              rig.projector.centre_in_rig(),
              SurfaceGrid(raw.grid),
              std::vector<Fate>(raw.cloud.size(), Fate::kept),
              std::vector<Eigen::Vector3d>(raw.cloud.size(), Eigen::Vector3d::Zero())};
    mark_jumps_and_lonely(work);
    find_normals(work);
    mark_small_pieces(work);
    OutlierReport report;
    keep(work, report);
    return report;
}

}  // namespace planlight
