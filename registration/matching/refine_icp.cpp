#include "registration/matching/refine_icp.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "planning_io/types/statistics.h"
#include "planning_io/types/triangle_mesh.h"
#include "registration/matching/gauss_newton.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

/// Whether the skin nearest to the point is not skin: a seal, the end of the volume, or outside the table.
bool off_the_skin(const SkinLut& lut, const Vector3d& p_in_ct) {
    const SkinPoint* s = lut.nearest_skin(p_in_ct);
    return !s || s->flags != kSkin;
}

std::vector<std::uint8_t> mark_off_the_skin(std::span<const Vector3d> points_in_rig, const SkinLut& lut,
                                            const RigidTransform& ct_from_rig) {
    std::vector<std::uint8_t> marks(points_in_rig.size());
    for (std::size_t i = 0; i < marks.size(); ++i) marks[i] = off_the_skin(lut, ct_from_rig * points_in_rig[i]);
    return marks;
}

Vector3d mean_of_unmarked(std::span<const Vector3d> points, std::span<const std::uint8_t> marks) {
    Vector3d sum = Vector3d::Zero();
    double count = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!marks.empty() && marks[i]) continue;
        sum += points[i];
        ++count;
    }
    return sum / std::max(count, 1.0);
}

/// How many points take part in an iteration: few while the pose is far, all at the end.
constexpr std::size_t kFew = 1500, kSome = 5000;

/// Up to `max_points` of the finite points: a random, fixed sample of about `kFew` first, then more up to about
/// `kSome`, then the rest. Within each the points stay in the order of the scan, where neighbours follow each other and
/// lie close together in the table too.
struct Sample {
    std::vector<Vector3d> points;
    std::size_t few = 0, some = 0;
};

Sample sample_of(const PointCloud& cloud, int max_points) {
    std::vector<std::size_t> finite;
    finite.reserve(cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i)
        if (cloud.points_in_rig[i].allFinite()) finite.push_back(i);
    const auto draw = [](std::size_t i) {  // even in [0, 1), the same for the same point
        std::uint64_t h = (i + 1) * 0x9E3779B97F4A7C15u;
        h = (h ^ (h >> 29)) * 0xBF58476D1CE4E5B9u;
        return static_cast<double>((h ^ (h >> 32)) >> 11) * 0x1p-53;
    };
    const auto all = static_cast<double>(std::max<std::size_t>(finite.size(), 1));
    const double few = kFew / all, some = kSome / all, most = std::max(max_points, 0) / all;
    Sample sample;
    sample.points.reserve(finite.size());
    const auto take = [&](double from, double to) {
        for (const std::size_t i : finite)
            if (const double u = draw(i); u >= from && u < to) sample.points.push_back(cloud.points_in_rig[i]);
        return sample.points.size();
    };
    sample.few = take(0, std::min(few, most));
    sample.some = take(few, std::min(some, most));
    take(some, most);
    return sample;
}

/// The paper's equations: point to the skin point behind the table's pointer.
NormalEquations point_to_point_equations(std::span<const Vector3d> points_in_rig, const SkinLut& lut,
                                         const RigidTransform& ct_from_rig, const Vector3d& centre_in_ct,
                                         double scale_mm, double max_pair_mm) {
    NormalEquations result;
    for (const Vector3d& p : points_in_rig) {
        const Vector3d x = ct_from_rig * p;
        const SkinPoint* s = lut.nearest_skin(x);
        if (!s || s->flags != kSkin) continue;
        const Vector3d residual = x - s->position_in_ct.cast<double>();
        const double distance_mm = residual.norm();
        if (distance_mm > max_pair_mm) continue;
        ++result.used;
        const double w = tukey_weight(distance_mm, scale_mm);
        const Eigen::Matrix<double, 3, 6> J = movement_by_twist(x - centre_in_ct);
        result.H.noalias() += w * J.transpose() * J;
        result.g.noalias() += w * J.transpose() * residual;
    }
    return result;
}

double distance_to_skin(const SkinLut& lut, const DistanceField& field, IcpSettings::Mode mode,
                        const Vector3d& p_in_ct) {
    if (mode == IcpSettings::Mode::closest_point) {
        const SkinPoint* s = lut.nearest_skin(p_in_ct);
        return s ? (s->position_in_ct.cast<double>() - p_in_ct).norm() : std::numeric_limits<double>::infinity();
    }
    double d;
    Vector3d unused;
    return field.sample(p_in_ct, d, unused) ? std::abs(d) : std::numeric_limits<double>::infinity();
}

/// Of the points that the last stage did not leave out.
void measure_residuals(std::span<const Vector3d> points, std::span<const std::uint8_t> skip, const SkinLut& lut,
                       const DistanceField& field, const IcpSettings& settings, IcpResult& result) {
    std::vector<double> all;
    double sum = 0;
    result.used = result.inliers = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (skip[i]) continue;
        const Vector3d x = result.ct_from_rig * points[i];
        const double d = distance_to_skin(lut, field, settings.mode, x);
        all.push_back(d);
        if (d <= settings.max_pair_mm) ++result.used;
        if (d > 3 * settings.last_scale_mm) continue;
        ++result.inliers;
        sum += d * d;
    }
    if (result.inliers > 0) result.residual_rms_mm = std::sqrt(sum / static_cast<double>(result.inliers));
    if (all.empty()) return;
    result.residual_median_mm = median(std::move(all));
}

struct Stage {
    std::size_t points;
    double first_scale_mm, last_scale_mm;
    int max_iterations;
    double stop_mm;
};

std::vector<Stage> stages_of(const IcpSettings& settings, const Sample& sample) {
    const double middle_mm = std::sqrt(settings.first_scale_mm * settings.last_scale_mm);
    const int iterations = settings.max_iterations > 0                         ? settings.max_iterations
                           : settings.mode == IcpSettings::Mode::closest_point ? 300
                                                                               : 60;
    const int third = std::max(iterations / 3, 1);
    return {{sample.few, settings.first_scale_mm, middle_mm, third, 0.02},
            {sample.some, middle_mm, settings.last_scale_mm, third, 0.005},
            {sample.points.size(), settings.last_scale_mm, settings.last_scale_mm, std::max(iterations - 2 * third, 1),
             settings.stop_mm}};
}

}  // namespace

IcpResult refine_icp(const PointCloud& cloud, const SkinLut& lut, const RigidTransform& ct_from_rig,
                     const IcpSettings& settings) {
    constexpr double kOutside = 0.5;  // cloth lies outside of the body: it is let go of sooner
    IcpResult result;
    result.ct_from_rig = ct_from_rig;
    const Sample sample = sample_of(cloud, settings.max_points);
    const std::vector<Vector3d>& points = sample.points;
    if (points.size() < 6 || lut.skin.empty() || lut.distance_mm.empty()) return result;
    const DistanceField field(lut);
    const PointArrays arrays(points, mean_of_unmarked(points, {}));
    std::vector<std::uint8_t> skip;
    for (const Stage& stage : stages_of(settings, sample)) {
        const std::span<const Vector3d> some(points.data(), stage.points);
        skip = mark_off_the_skin(some, lut, result.ct_from_rig);
        const Vector3d centre_in_rig = mean_of_unmarked(some, skip);
        double scale_mm = stage.first_scale_mm;
        for (int i = 0; i < stage.max_iterations; ++i) {
            result.centre_in_ct = result.ct_from_rig * centre_in_rig;
            const NormalEquations equations =
                settings.mode == IcpSettings::Mode::signed_distance
                    ? point_to_plane_equations(
                          arrays, some.size(), skip, field, result.ct_from_rig, result.centre_in_ct, scale_mm,
                          std::max(settings.last_scale_mm, kOutside * scale_mm), settings.max_pair_mm)
                    : point_to_point_equations(some, lut, result.ct_from_rig, result.centre_in_ct, scale_mm,
                                               settings.max_pair_mm);
            if (equations.used < 6) return result;
            double moved_mm;
            result.ct_from_rig = after_step(equations, result.ct_from_rig, result.centre_in_ct, 30, moved_mm);
            result.information = equations.H;
            ++result.iterations;
            result.converged = moved_mm < settings.stop_mm;
            if (moved_mm < stage.stop_mm && scale_mm <= stage.last_scale_mm) break;
            scale_mm = std::max(stage.last_scale_mm, 0.7 * scale_mm);
        }
    }
    result.ct_from_rig.linear() = Eigen::Quaterniond(result.ct_from_rig.linear()).normalized().toRotationMatrix();
    measure_residuals(points, skip, lut, field, settings, result);
    return result;
}

}  // namespace planlight
