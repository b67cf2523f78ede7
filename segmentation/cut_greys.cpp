#include "segmentation/cut_greys.h"

#include <algorithm>
#include <limits>

#include "segmentation/distance_transform.h"
#include "segmentation/head_survey.h"

namespace planlight {
namespace {

constexpr double kNear_mm = 24, kDeep_mm = 4;
constexpr double kCutAir = 0.95, kCutBody = 0.06;  // airways are 0.03 of a head, its bone 0.1 and more

/// Without distances, which take a second: half of the body lies deep, and as many of its voxels are at the least
/// value.
bool may_be_cut(const Volume& volume, const SkinMask& mask, float least) {
    constexpr double kDeepShare = 0.5;
    double body = 0, body_cut = 0;
    for (std::size_t v = 0; v < volume.values.size(); ++v)
        if (mask.body[v] != 0) ++body, body_cut += volume.values[v] == least;
    return body_cut > kDeepShare * kCutBody * body;
}

}  // namespace

bool CutGreys::dark_end() const {
    return air_share > kCutAir && body_share > kCutBody;
}

CutGreys cut_greys(const Volume& volume, const SkinMask& mask) {
    CutGreys cut;
    if (volume.is_hu || mask.body.size() != volume.values.size()) return cut;
    float least = std::numeric_limits<float>::infinity();
    for (const float v : volume.values)
        if (v < least) least = v;
    if (!may_be_cut(volume, mask, least)) return cut;
    const VoxelGrid grid = grid_of(volume);
    const std::vector<float> out = distance_from(mask.body, 1, grid, kNear_mm),
                             depth = distance_from(mask.body, 0, grid, kDeep_mm + 2);
    double air = 0, air_cut = 0, body = 0, body_cut = 0;
    for (std::size_t v = 0; v < volume.values.size(); ++v) {
        if (mask.body[v] != 0 && depth[v] > static_cast<float>(kDeep_mm)) {
            ++body;
            body_cut += volume.values[v] == least;
        } else if (mask.body[v] == 0 && out[v] > static_cast<float>(kDeep_mm) &&
                   out[v] < static_cast<float>(kNear_mm)) {
            ++air;
            air_cut += volume.values[v] == least;
        }
    }
    if (air > 0 && body > 0) cut = {air_cut / air, body_cut / body};
    return cut;
}

double bright_end_share(const Volume& volume, const SkinMask& mask) {
    if (volume.is_hu || mask.body.size() != volume.values.size() || volume.values.empty()) return 0;
    const float greatest = *std::max_element(volume.values.begin(), volume.values.end());
    double body = 0, cut = 0;
    for (std::size_t v = 0; v < volume.values.size(); ++v)
        if (mask.body[v] != 0) ++body, cut += volume.values[v] == greatest;
    return body > 0 ? cut / body : 0;
}

}  // namespace planlight
