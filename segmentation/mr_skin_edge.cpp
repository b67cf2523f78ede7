#include "segmentation/mr_skin_edge.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "segmentation/volume_sample.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kStep_mm = 0.25;
constexpr int kSide = 16;                           // samples on each side of the vertex: 4 mm
using Profile = std::array<double, 2 * kSide + 1>;  // from the inside out

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

double mean(const Profile& profile, double from_mm, double to_mm) {
    double sum = 0;
    int count = 0;
    for (int s = static_cast<int>(std::lround(from_mm / kStep_mm));
         s <= static_cast<int>(std::lround(to_mm / kStep_mm)); ++s, ++count)
        sum += profile[static_cast<std::size_t>(s + kSide)];
    return sum / count;
}

/// Where the profile falls to half way, nearest to its middle; mm outwards.
double half_way(const Profile& profile, double threshold, double reach_mm) {
    const double air = mean(profile, 2, 4), tissue = mean(profile, -2.5, -1), half = (air + tissue) / 2;
    if (!(air < threshold) || !(tissue > threshold)) return kUnknown;  // a fold: skin again outside
    double found = kUnknown;
    for (std::size_t s = 0; s + 1 < profile.size(); ++s) {
        if (!(profile[s] >= half) || !(profile[s + 1] < half)) continue;
        const double at =
            (static_cast<double>(s) + (profile[s] - half) / (profile[s] - profile[s + 1]) - kSide) * kStep_mm;
        if (std::abs(at) <= reach_mm && !(std::abs(at) >= std::abs(found))) found = at;
    }
    return found;
}

/// Each move becomes the mean of its own and its neighbours'; those unknown take part once a neighbour is known.
void smooth(std::vector<double>& moves_mm, const TriangleMesh& mesh, int rounds) {
    for (int round = 0; round < rounds; ++round) {
        std::vector<double> sum(moves_mm.size(), 0), count(moves_mm.size(), 0);
        const auto add = [&](std::int32_t to, std::int32_t from) {
            const double move = moves_mm[static_cast<std::size_t>(from)];
            if (std::isnan(move)) return;
            sum[static_cast<std::size_t>(to)] += move;
            count[static_cast<std::size_t>(to)] += 1;
        };
        for (const auto& t : mesh.triangles)
            for (std::size_t c = 0; c < 3; ++c) add(t[c], t[c]), add(t[c], t[(c + 1) % 3]);
        for (std::size_t v = 0; v < moves_mm.size(); ++v)
            if (count[v] > 0) moves_mm[v] = sum[v] / count[v];
    }
}

}  // namespace

std::size_t move_to_edges(TriangleMesh& mesh, const Volume& volume, double threshold, const EdgeSettings& settings) {
    const Eigen::Affine3d voxel_from_ct = volume.ct_from_voxel.inverse();
    std::vector<double> moves_mm(mesh.vertices_in_ct.size(), kUnknown);
    const auto is_skin = [&](std::size_t v) { return mesh.flags.empty() || mesh.flags[v] == kSkin; };
    tbb::parallel_for(std::size_t{0}, moves_mm.size(), [&](std::size_t v) {
        if (!is_skin(v)) return;
        const Vector3d at = voxel_from_ct * mesh.vertices_in_ct[v],
                       step = voxel_from_ct.linear() * (kStep_mm * mesh.normals_in_ct[v]);
        Profile profile;
        for (int s = -kSide; s <= kSide; ++s)
            profile[static_cast<std::size_t>(s + kSide)] = value_at(volume, at + s * step).value_or(kUnknown);
        moves_mm[v] = half_way(profile, threshold, settings.reach_mm);
    });
    const auto found = std::count_if(moves_mm.begin(), moves_mm.end(), [](double move) { return !std::isnan(move); });
    smooth(moves_mm, mesh, settings.smoothing_rounds);
    for (std::size_t v = 0; v < moves_mm.size(); ++v)
        if (is_skin(v) && !std::isnan(moves_mm[v])) mesh.vertices_in_ct[v] += moves_mm[v] * mesh.normals_in_ct[v];
    return static_cast<std::size_t>(found);
}

}  // namespace planlight
