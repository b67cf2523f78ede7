#include "segmentation/head_survey.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace planlight {
namespace {

using Eigen::Vector3d;

/// The box of the volume's voxel centres in ct, half a voxel wider.
Eigen::AlignedBox3d box_in_ct(const Volume& volume) {
    Eigen::AlignedBox3d box;
    for (int corner = 0; corner < 8; ++corner) {
        Vector3d voxel;
        for (int a = 0; a < 3; ++a)
            voxel[a] = (corner >> a) & 1 ? volume.size[static_cast<std::size_t>(a)] - 0.5 : -0.5;
        box.extend(volume.ct_from_voxel * voxel);
    }
    return box;
}

/// Trilinear, with the last values held half a voxel beyond the centres; not finite outside.
struct Sampler {
    const Volume& volume;

    float operator()(const Vector3d& voxel) const {
        std::size_t low[3], high[3];
        float f[3];
        for (int a = 0; a < 3; ++a) {
            const int last = volume.size[static_cast<std::size_t>(a)] - 1;
            if (voxel[a] < -0.5 || voxel[a] > last + 0.5) return NAN;
            const double inside = std::clamp(voxel[a], 0.0, static_cast<double>(last));
            const int floor = std::min(static_cast<int>(inside), std::max(0, last - 1));
            f[a] = static_cast<float>(inside - floor);
            low[a] = static_cast<std::size_t>(floor);
            high[a] = static_cast<std::size_t>(std::min(floor + 1, last));
        }
        const std::size_t row = static_cast<std::size_t>(volume.size[0]),
                          slab = row * static_cast<std::size_t>(volume.size[1]);
        const auto at = [&](std::size_t i, std::size_t j, std::size_t k) {
            return volume.values[k * slab + j * row + i];
        };
        const auto along = [&](std::size_t j, std::size_t k) {
            return at(low[0], j, k) + f[0] * (at(high[0], j, k) - at(low[0], j, k));
        };
        const auto plane = [&](std::size_t k) {
            return along(low[1], k) + f[1] * (along(high[1], k) - along(low[1], k));
        };
        return plane(low[2]) + f[2] * (plane(high[2]) - plane(low[2]));
    }
};

constexpr double kLeastEdges = 0.25;  // share of a box's edges that shows something, for air to enter there
constexpr double kMostOff = 0.08;     // how far inside of what was measured such a box may lie, of its width each side
constexpr double kOffStep = 0.01;

/// 1 along the edges of a box in the volume's voxels, `width` of them inwards.
Mask edges_of(const Eigen::AlignedBox3d& box, const Vector3d& width, const std::vector<Vector3d>& places) {
    Mask edges(places.size(), 0);
    tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t v) {
        if (!box.contains(places[v])) return;
        int at_ends = 0;
        for (int a = 0; a < 3; ++a)
            at_ends += places[v][a] < box.min()[a] + width[a] || places[v][a] > box.max()[a] - width[a];
        edges[v] = at_ends >= 2;
    });
    return edges;
}

/// Where blank places lie all round what was measured (padding, a picture straightened for its gradients), nothing is
/// measured along the edges of the volume's box, and air would find no way in: the edges are then those of the largest
/// box within that shows something along enough of them. Its faces would not do: one of them cuts the neck.
Mask rim_within_blank(const HeadSurvey& survey, const Eigen::Affine3d& voxel_from_ct, const Vector3d& width) {
    std::vector<Vector3d> places(survey.measured.size());
    Eigen::AlignedBox3d all;
    for (std::size_t v = 0; v < places.size(); ++v) {
        places[v] = voxel_from_ct * survey.place_of(v);
        if (survey.measured[v]) all.extend(places[v]);
    }
    for (double off = 0; !all.isEmpty() && off < kMostOff + kOffStep / 2; off += kOffStep) {
        const Vector3d inwards = off * all.sizes();
        Mask edges = edges_of({all.min() + inwards, all.max() - inwards}, width, places);
        std::size_t shown = 0, count = 0;
        for (std::size_t v = 0; v < edges.size(); ++v) count += edges[v], shown += edges[v] && survey.measured[v];
        if (static_cast<double>(shown) < kLeastEdges * static_cast<double>(count)) continue;
        for (std::size_t v = 0; v < edges.size(); ++v) edges[v] = edges[v] && survey.measured[v];
        return edges;
    }
    return Mask(survey.measured.size(), 0);
}

}  // namespace

Vector3d HeadSurvey::place_of(std::size_t index) const {
    const std::size_t ni = grid.row(), nj = static_cast<std::size_t>(grid.size[1]);
    return first_in_ct + step_mm() * Vector3d(static_cast<double>(index % ni), static_cast<double>(index / ni % nj),
                                              static_cast<double>(index / ni / nj));
}

bool HeadSurvey::has_rim() const {
    return std::find(rim.begin(), rim.end(), 1) != rim.end();
}

HeadSurvey survey_of(const Volume& volume, const SurveySettings& settings) {
    HeadSurvey survey;
    const Eigen::AlignedBox3d box = box_in_ct(volume);
    const double step = std::max(settings.step_mm, std::cbrt(box.volume() / static_cast<double>(settings.most_voxels)));
    survey.grid.spacing_mm = Vector3d::Constant(step);
    for (int a = 0; a < 3; ++a)
        survey.grid.size[static_cast<std::size_t>(a)] = std::max(3, static_cast<int>(std::ceil(box.sizes()[a] / step)));
    const Vector3d spare = Vector3d(survey.grid.size[0], survey.grid.size[1], survey.grid.size[2]) * step - box.sizes();
    survey.first_in_ct = box.min() - spare / 2 + Vector3d::Constant(step / 2);
    survey.values.assign(survey.grid.count(), 0);
    survey.measured.assign(survey.grid.count(), 0);
    survey.rim.assign(survey.grid.count(), 0);

    const Eigen::Affine3d voxel_from_ct = volume.ct_from_voxel.inverse();
    const Sampler sample{volume};
    std::array<Vector3d, 8> asides;  // from the middle of a voxel to its eight places, in voxels of the volume
    for (std::size_t corner = 0; corner < 8; ++corner) {
        Vector3d aside_in_ct;
        for (int a = 0; a < 3; ++a) aside_in_ct[a] = (corner >> a) & 1 ? step / 4 : -step / 4;
        asides[corner] = voxel_from_ct.linear() * aside_in_ct;
    }
    Vector3d rim_width;  // in voxels of the volume
    for (int a = 0; a < 3; ++a) rim_width[a] = 1.2 * step / volume.ct_from_voxel.linear().col(a).norm();
    tbb::parallel_for(0, survey.grid.size[2], [&](int k) {
        for (int j = 0; j < survey.grid.size[1]; ++j)
            for (int i = 0; i < survey.grid.size[0]; ++i) {
                const std::size_t at = survey.index(i, j, k);
                const Vector3d middle = voxel_from_ct * (survey.first_in_ct + step * Vector3d(i, j, k));
                float sum = 0;
                int count = 0;
                for (const Vector3d& aside : asides) {
                    const float value = sample(middle + aside);
                    if (!std::isfinite(value)) continue;
                    sum += value;
                    ++count;
                }
                if (count < 4) continue;
                survey.values[at] = sum / static_cast<float>(count);
                survey.measured[at] = 1;
                int at_ends = 0;
                for (int a = 0; a < 3; ++a)
                    at_ends += middle[a] < rim_width[a] - 0.5 ||
                               middle[a] > volume.size[static_cast<std::size_t>(a)] - 0.5 - rim_width[a];
                survey.rim[at] = at_ends >= 2;
            }
    });
    if (!survey.has_rim()) survey.rim = rim_within_blank(survey, voxel_from_ct, rim_width);
    return survey;
}

std::vector<float> smoothed(const HeadSurvey& survey, const std::vector<float>& values) {
    const VoxelGrid& grid = survey.grid;
    std::vector<float> from = values, to(values.size());
    std::array<std::size_t, 3> strides{1, grid.row(), grid.slab()};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t stride = strides[axis], n = static_cast<std::size_t>(grid.size[axis]);
        tbb::parallel_for(0, grid.size[2], [&](int k) {
            const std::size_t begin = static_cast<std::size_t>(k) * grid.slab();
            for (std::size_t v = begin; v < begin + grid.slab(); ++v) {
                const std::size_t at = v / stride % n;
                float sum = 2 * from[v], weight = 2;
                if (at > 0 && survey.measured[v - stride]) sum += from[v - stride], weight += 1;
                if (at + 1 < n && survey.measured[v + stride]) sum += from[v + stride], weight += 1;
                to[v] = survey.measured[v] ? sum / weight : 0;
            }
        });
        std::swap(from, to);
    }
    return from;
}

}  // namespace planlight
