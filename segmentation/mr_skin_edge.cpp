#include "segmentation/mr_skin_edge.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "planning_io/types/statistics.h"
#include "planning_io/volume/volume_sample.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kStep_mm = 0.25;
constexpr int kSide = 32;  // samples on each side of the vertex: 8 mm
// Deeper than the edge's own blur, which is of about a voxel, and still in the skin: that of a scalp is 1.5 to 2.5 mm
// thick, and the fat under it shines. But more than half a voxel, which may be a thick slice.
constexpr double kOfBlur = 1.5, kLeast_mm = 1.5, kMost_mm = 2, kOfVoxel = 0.6;
using Profile = std::array<float, 2 * kSide + 1>;  // from the inside out

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

double mean(const Profile& profile, double from_mm, double to_mm) {
    double sum = 0;
    int count = 0;
    for (int s = static_cast<int>(std::lround(from_mm / kStep_mm));
         s <= static_cast<int>(std::lround(to_mm / kStep_mm)); ++s, ++count)
        sum += static_cast<double>(profile[static_cast<std::size_t>(s + kSide)]);
    return sum / count;
}

/// The outermost place where the profile has risen half as far above the air as it has `deeper` samples further in; mm
/// outwards.
///
/// The half of the first crest would not do: fat shines two to three times as bright as the skin over it (T1), and bone
/// in a CT that is not in HU, so that the half of their crest lies at the skin's inner side.
double half_way(const Profile& profile, double threshold, double reach_mm, int deeper) {
    const double air = std::min(mean(profile, 2, 4), mean(profile, 3, 5));
    if (!(air < threshold)) return kUnknown;  // a fold: skin again outside
    const auto over_half = [&](int s) {
        const auto at = static_cast<std::size_t>(s + kSide);
        return static_cast<double>(profile[at]) - air -
               (static_cast<double>(profile[at - static_cast<std::size_t>(deeper)]) - air) / 2;
    };
    const int reach = static_cast<int>(reach_mm / kStep_mm);
    for (int s = reach; s >= -reach; --s) {
        const double here = over_half(s), outer = over_half(s + 1);
        if (!(static_cast<double>(profile[static_cast<std::size_t>(s + kSide - deeper)]) > threshold) || !(here >= 0))
            continue;
        return outer < 0 ? (s + here / (here - outer)) * kStep_mm : kUnknown;
    }
    return kUnknown;
}

bool is_skin(const TriangleMesh& mesh, std::size_t v) {
    return mesh.flags.empty() || mesh.flags[v] == kSkin;
}

/// For each vertex those it shares a triangle with, one after the other; `first[v]` to `first[v + 1]`.
struct Neighbours {
    std::vector<std::size_t> first;
    std::vector<std::int32_t> of;
};

Neighbours neighbours_of(const TriangleMesh& mesh) {
    Neighbours next;
    next.first.assign(mesh.vertices_in_ct.size() + 1, 0);
    for (const auto& t : mesh.triangles)
        for (const auto c : t) ++next.first[static_cast<std::size_t>(c) + 1];
    std::partial_sum(next.first.begin(), next.first.end(), next.first.begin());
    next.of.resize(next.first.back());
    std::vector<std::size_t> at(next.first.begin(), next.first.end() - 1);
    for (const auto& t : mesh.triangles)  // of a closed mesh each neighbour once: the corner that follows
        for (std::size_t c = 0; c < 3; ++c) next.of[at[static_cast<std::size_t>(t[c])]++] = t[(c + 1) % 3];
    return next;
}

/// A move further than this from the middle of those round it is noise, or another edge.
constexpr double kAlone_mm = 0.7;

void forget_lonely(std::vector<double>& moves_mm, const Neighbours& next) {
    const std::vector<double> given = moves_mm;
    tbb::parallel_for(std::size_t{0}, given.size(), [&](std::size_t v) {
        if (std::isnan(given[v])) return;
        std::vector<double> round;
        for (std::size_t n = next.first[v]; n < next.first[v + 1]; ++n) {
            const auto other = static_cast<std::size_t>(next.of[n]);
            for (std::size_t m = next.first[other]; m < next.first[other + 1]; ++m)
                if (const double move = given[static_cast<std::size_t>(next.of[m])]; !std::isnan(move))
                    round.push_back(move);
        }
        if (round.size() < 6 || std::abs(given[v] - median(std::move(round))) > kAlone_mm) moves_mm[v] = kUnknown;
    });
}

/// Each move becomes the mean of its own and its neighbours'; those unknown take part once a neighbour is known.
void smooth(std::vector<double>& moves_mm, const Neighbours& next, int rounds) {
    std::vector<double> smoothed(moves_mm.size());
    for (int round = 0; round < rounds; ++round) {
        tbb::parallel_for(std::size_t{0}, moves_mm.size(), [&](std::size_t v) {
            double sum = std::isnan(moves_mm[v]) ? 0 : moves_mm[v], count = !std::isnan(moves_mm[v]);
            for (std::size_t n = next.first[v]; n < next.first[v + 1]; ++n) {
                const double move = moves_mm[static_cast<std::size_t>(next.of[n])];
                if (!std::isnan(move)) sum += move, count += 1;
            }
            smoothed[v] = count > 0 ? sum / count : kUnknown;
        });
        std::swap(moves_mm, smoothed);
    }
}

/// Of each vertex that is skin; of others, and beyond the volume, not a number.
std::vector<Profile> profiles_of(const TriangleMesh& mesh, const Volume& volume) {
    const Eigen::Affine3d voxel_from_ct = volume.ct_from_voxel.inverse();
    std::vector<Profile> profiles(mesh.vertices_in_ct.size());
    tbb::parallel_for(std::size_t{0}, profiles.size(), [&](std::size_t v) {
        profiles[v].fill(static_cast<float>(kUnknown));
        if (!is_skin(mesh, v)) return;
        const Vector3d at = voxel_from_ct * mesh.vertices_in_ct[v],
                       step = voxel_from_ct.linear() * (kStep_mm * mesh.normals_in_ct[v]);
        for (int s = -kSide; s <= kSide; ++s)
            profiles[v][static_cast<std::size_t>(s + kSide)] =
                static_cast<float>(value_at(volume, at + s * step).value_or(kUnknown));
    });
    return profiles;
}

/// Each profile becomes the mean of its own and its neighbours', where they are known.
void average_profiles(std::vector<Profile>& profiles, const Neighbours& next, int rounds) {
    std::vector<Profile> averaged(rounds > 0 ? profiles.size() : 0);
    for (int round = 0; round < rounds; ++round) {
        tbb::parallel_for(std::size_t{0}, profiles.size(), [&](std::size_t v) {
            Profile sum = profiles[v], count{};
            for (std::size_t s = 0; s < sum.size(); ++s) count[s] = static_cast<float>(!std::isnan(sum[s]));
            for (std::size_t n = next.first[v]; n < next.first[v + 1]; ++n) {
                const Profile& other = profiles[static_cast<std::size_t>(next.of[n])];
                for (std::size_t s = 0; s < sum.size(); ++s)
                    if (!std::isnan(sum[s]) && !std::isnan(other[s])) sum[s] += other[s], count[s] += 1;
            }
            for (std::size_t s = 0; s < sum.size(); ++s) averaged[v][s] = sum[s] / std::max(count[s], 1.0F);
        });
        std::swap(profiles, averaged);
    }
}

}  // namespace

std::size_t move_to_edges(TriangleMesh& mesh, const Volume& volume, double threshold, const EdgeSettings& settings) {
    const Neighbours next = neighbours_of(mesh);
    std::vector<Profile> profiles = profiles_of(mesh, volume);
    average_profiles(profiles, next, settings.profile_rounds);
    std::vector<double> moves_mm(mesh.vertices_in_ct.size(), kUnknown);
    tbb::parallel_for(std::size_t{0}, moves_mm.size(), [&](std::size_t v) {
        if (!is_skin(mesh, v)) return;
        // How long a voxel is along the normal.
        const double voxel_mm =
            (volume.ct_from_voxel.linear().transpose() * mesh.normals_in_ct[v]).cwiseAbs().maxCoeff();
        const double in_skin_mm = std::clamp(kOfBlur * voxel_mm, kLeast_mm, kMost_mm),
                     deeper_mm = std::min(std::max(in_skin_mm, kOfVoxel * voxel_mm), 4.0);
        moves_mm[v] = half_way(profiles[v], threshold, settings.reach_mm, static_cast<int>(deeper_mm / kStep_mm));
    });
    const auto found = std::count_if(moves_mm.begin(), moves_mm.end(), [](double move) { return !std::isnan(move); });
    forget_lonely(moves_mm, next);
    smooth(moves_mm, next, settings.smoothing_rounds);
    for (std::size_t v = 0; v < moves_mm.size(); ++v)
        if (is_skin(mesh, v) && !std::isnan(moves_mm[v])) mesh.vertices_in_ct[v] += moves_mm[v] * mesh.normals_in_ct[v];
    return static_cast<std::size_t>(found);
}

}  // namespace planlight
