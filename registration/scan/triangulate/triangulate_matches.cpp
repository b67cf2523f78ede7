#include "registration/scan/triangulate/triangulate_matches.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "planning_io/types/statistics.h"
#include "registration/scan/triangulate/triangulate_kernel.h"
#include "registration/scan/triangulate/triangulate_parts.h"

namespace planlight {
namespace {

using triangulate_kernel::Device;
using triangulate_kernel::kLanes;
using triangulate_kernel::Points;
using Seen = Triangulation::Seen;

constexpr double kMaxSigma_mm = 5;    // a worse point says nothing about where the skin is
constexpr double kMaxStep_mm = 0.05;  // after a smaller one the next would be under a tenth of a micrometre
constexpr int kMaxIterations = 6;
constexpr std::size_t kSample = 20000;  // of the points that the cameras placed

/// What became of a match.
enum class Fate : unsigned char { point, disagree, outside_volume };

/// A batch of matches of one kind as it comes out of the arithmetic.
struct Batch {
    std::size_t count = 0;
    std::array<Fate, kLanes> fate;
    Points points;
};

struct Rig {
    Device left, right, projector;
    explicit Rig(const RigCalibration& rig)
        : left(rig.left_camera), right(rig.right_camera), projector(rig.projector) {}
};

/// Fills the lanes; unused ones repeat the first match.
void load(const std::vector<const ViewMatch*>& matches, std::size_t begin, Batch& batch) {
    batch.count = std::min<std::size_t>(kLanes, matches.size() - begin);
    Points& p = batch.points;
    for (std::size_t i = 0; i < kLanes; ++i) {
        const ViewMatch& m = *matches[begin + (i < batch.count ? i : 0)];
        p.pixel_x[i] = m.pixel.x();
        p.pixel_y[i] = m.pixel.y();
        p.right_x[i] = m.right.x();
        p.right_y[i] = m.right.y();
        p.code_x[i] = m.code.x();
        p.code_y[i] = m.code.y();
        p.sigma[i] = m.sigma_px;
        p.right_sigma[i] = m.right_sigma_px;
        p.by_code_xx[i] = m.right_by_code(0, 0);
        p.by_code_xy[i] = m.right_by_code(0, 1);
        p.by_code_yx[i] = m.right_by_code(1, 0);
        p.by_code_yy[i] = m.right_by_code(1, 1);
    }
}

void place(const Rig& rig, Seen seen, const TriangulationSettings& settings, Batch& batch) {
    const triangulate_kernel::Sigmas sigmas{settings.camera_sigma_px, settings.projector_sigma_px};
    Points& p = batch.points;
    const Device& camera = seen == Seen::right_only ? rig.right : rig.left;
    if (seen == Seen::both)
        start_three(rig.left, rig.right, rig.projector, p);
    else
        start_two(camera, rig.projector, p);
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
        if (seen == Seen::both)
            adjust_three(rig.left, rig.right, rig.projector, sigmas, p);
        else
            adjust_two(camera, rig.projector, sigmas, p);
        if (*std::max_element(p.step_squared, p.step_squared + batch.count) < kMaxStep_mm * kMaxStep_mm) break;
    }
    find_worst_sigma(p);
    const double allowed = settings.max_residual_sigma * settings.max_residual_sigma;
    for (std::size_t i = 0; i < batch.count; ++i) {
        const double dx = p.x[i] - rig.projector.eye[0], dy = p.y[i] - rig.projector.eye[1],
                     dz = p.z[i] - rig.projector.eye[2];
        const double away = std::sqrt(dx * dx + dy * dy + dz * dz);
        const bool solved =
            p.good[i] != 0 && p.step_squared[i] < kMaxStep_mm * kMaxStep_mm && p.residual_squared[i] <= allowed;
        if (!solved)
            batch.fate[i] = Fate::disagree;
        else if (!(away >= settings.near_mm && away <= settings.far_mm))
            batch.fate[i] = Fate::outside_volume;
        else
            batch.fate[i] = p.sigma_mm[i] < kMaxSigma_mm ? Fate::point : Fate::disagree;
    }
}

/// The points of a run of matches, and the evidence of those that the cameras placed without the projector.
struct Part {
    std::vector<Eigen::Vector3d> points;
    std::vector<float> sigma_mm;
    std::vector<const ViewMatch*> matches;
    std::size_t disagree = 0, outside_volume = 0;

    std::size_t by_cameras = 0;
    double epipolar_squares = 0;
    std::vector<Triangulation::ByCameras> sample;
    std::vector<float> offset_x, offset_y;  // of the sample

    void reserve(std::size_t n) {
        points.reserve(n);
        sigma_mm.reserve(n);
        matches.reserve(n);
    }
};

void keep_points(const std::vector<const ViewMatch*>& matches, std::size_t begin, const Batch& batch, Part& part) {
    const Points& p = batch.points;
    for (std::size_t i = 0; i < batch.count; ++i) {
        if (batch.fate[i] == Fate::disagree) ++part.disagree;
        if (batch.fate[i] == Fate::outside_volume) ++part.outside_volume;
        if (batch.fate[i] != Fate::point) continue;
        part.points.emplace_back(p.x[i], p.y[i], p.z[i]);
        part.sigma_mm.push_back(static_cast<float>(p.sigma_mm[i]));
        part.matches.push_back(matches[begin + i]);
    }
}

void keep_evidence(const std::vector<const ViewMatch*>& matches, std::size_t begin, const Batch& batch,
                   std::size_t sample_every, Part& part) {
    const Points& p = batch.points;
    for (std::size_t i = 0; i < batch.count; ++i) {
        if (p.good[i] == 0) continue;
        ++part.by_cameras;
        part.epipolar_squares += p.epipolar[i] * p.epipolar[i];
        if ((begin + i) % sample_every != 0) continue;
        part.offset_x.push_back(static_cast<float>(p.offset_x[i]));
        part.offset_y.push_back(static_cast<float>(p.offset_y[i]));
        part.sample.push_back({{p.start_x[i], p.start_y[i], p.start_z[i]}, matches[begin + i]->code, p.epipolar[i]});
    }
}

std::vector<Part> place_all(const std::vector<const ViewMatch*>& matches, const Rig& rig, Seen seen,
                            const TriangulationSettings& settings) {
    constexpr std::size_t kBatchesAPart = 16;
    const std::size_t batches = (matches.size() + kLanes - 1) / kLanes, sample_every = 1 + matches.size() / kSample;
    std::vector<Part> parts((batches + kBatchesAPart - 1) / kBatchesAPart);
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t k) {
        const auto batch = std::make_unique<Batch>();
        parts[k].reserve(kBatchesAPart * kLanes);
        for (std::size_t b = k * kBatchesAPart; b < std::min(batches, (k + 1) * kBatchesAPart); ++b) {
            load(matches, b * kLanes, *batch);
            place(rig, seen, settings, *batch);
            keep_points(matches, b * kLanes, *batch, parts[k]);
            if (seen == Seen::both) keep_evidence(matches, b * kLanes, *batch, sample_every, parts[k]);
        }
    });
    return parts;
}

void append(const std::vector<Part>& parts, Seen seen, Triangulation& result) {
    std::vector<std::size_t> begin{result.cloud.size()};
    for (const Part& part : parts) {
        begin.push_back(begin.back() + part.points.size());
        result.disagree += part.disagree;
        result.outside_volume += part.outside_volume;
    }
    const std::size_t size = begin.back();
    (seen == Seen::both ? result.three_view : result.two_view) += size - begin.front();
    result.cloud.points_in_rig.resize(size);
    result.cloud.sigma_mm.resize(size);
    result.cloud.pixels_in_projector.resize(size);
    result.grid.resize(size);
    result.seen.resize(size, seen);
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t k) {
        const Part& part = parts[k];
        for (std::size_t i = 0; i < part.points.size(); ++i) {
            const Eigen::Vector2d& code = part.matches[i]->code;
            result.cloud.points_in_rig[begin[k] + i] = part.points[i];
            result.cloud.sigma_mm[begin[k] + i] = part.sigma_mm[i];
            result.cloud.pixels_in_projector[begin[k] + i] = code;
            result.grid[begin[k] + i] = (code.array() + 0.5).floor().cast<int>();
        }
    });
}

void tell_evidence(const std::vector<Part>& parts, Triangulation& result) {
    std::vector<float> offset_x, offset_y;
    double squares = 0;
    std::size_t count = 0;
    for (const Part& part : parts) {
        count += part.by_cameras;
        offset_x.insert(offset_x.end(), part.offset_x.begin(), part.offset_x.end());
        offset_y.insert(offset_y.end(), part.offset_y.begin(), part.offset_y.end());
        result.by_cameras.insert(result.by_cameras.end(), part.sample.begin(), part.sample.end());
        squares += part.epipolar_squares;
    }
    if (offset_x.empty()) return;
    result.epipolar_rms_px = std::sqrt(squares / static_cast<double>(count));
    tbb::parallel_invoke([&] { result.projector_offset_px.x() = median(std::move(offset_x)); },
                         [&] { result.projector_offset_px.y() = median(std::move(offset_y)); });
}

/// At an edge of an object, a shadow or the projector's picture, blur mixes light with darkness and shifts the code.
/// Two cameras see the same shift and agree on the place; with one camera it would go straight into depth.
bool near_an_edge(const ViewMatch& match, const CameraModel& projector) {
    constexpr double kRim_px = 3;
    const Eigen::Vector2d last(projector.width - 1, projector.height - 1);
    return !match.whole || match.code.minCoeff() < kRim_px || (last - match.code).minCoeff() < kRim_px;
}

/// The matches of one camera that may be used, every `every`-th.
std::vector<const ViewMatch*> usable(const LargeArray<ViewMatch>& matches, const CameraModel& projector,
                                     std::size_t every, Triangulation& result) {
    std::vector<const ViewMatch*> chosen;
    for (std::size_t i = 0; i < matches.size(); i += every) {
        if (near_an_edge(matches[i], projector))
            ++result.ragged;
        else
            chosen.push_back(&matches[i]);
    }
    return chosen;
}

}  // namespace

ViewMatches match_views(const DecodedView& left, const DecodedView& right, const RigCalibration& rig,
                        const TriangulationSettings& settings) {
    check_views(left, right, rig);
    if (left.row.empty()) throw std::invalid_argument("match_views: the views do not code the rows");
    return match_views(left, right, rig.projector.width, rig.projector.height,
                       stride_for(std::max(left.decoded, right.decoded), settings), settings.one_camera);
}

Triangulation triangulate_matches(const ViewMatches& matches, const RigCalibration& rig,
                                  const TriangulationSettings& settings, std::size_t every) {
    const Rig devices(rig);
    Triangulation result;
    result.stride = matches.stride;
    result.ragged = matches.ragged;
    std::vector<const ViewMatch*> both;
    both.reserve(matches.both.size() / every + 1);
    for (std::size_t i = 0; i < matches.both.size(); i += every) both.push_back(&matches.both[i]);
    const auto parts = place_all(both, devices, Seen::both, settings);
    append(parts, Seen::both, result);
    tell_evidence(parts, result);
    if (!settings.one_camera) {
        result.no_partner = matches.left_only.size();
        return result;
    }
    std::vector<Part> left, right;
    const auto left_only = usable(matches.left_only, rig.projector, every, result),
               right_only = usable(matches.right_only, rig.projector, every, result);
    tbb::parallel_invoke([&] { left = place_all(left_only, devices, Seen::left_only, settings); },
                         [&] { right = place_all(right_only, devices, Seen::right_only, settings); });
    append(left, Seen::left_only, result);
    append(right, Seen::right_only, result);
    return result;
}

}  // namespace planlight
