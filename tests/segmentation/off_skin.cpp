#include "tests/segmentation/off_skin.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "tests/segmentation/distance_to_mesh.h"

namespace planlight::test {
namespace {

/// The triangles that have a corner on a lid or an end of the volume.
TriangleMesh not_skin(const TriangleMesh& skin) {
    TriangleMesh lids;
    if (skin.flags.empty()) return lids;
    lids.vertices_in_ct = skin.vertices_in_ct;
    for (const auto& t : skin.triangles)
        if (std::any_of(t.begin(), t.end(),
                        [&](std::int32_t c) { return skin.flags[static_cast<std::size_t>(c)] != kSkin; }))
            lids.triangles.push_back(t);
    return lids;
}

}  // namespace

double OffSkin::percent() const {
    return asked > 0 ? 100.0 * static_cast<double>(off.size()) / static_cast<double>(asked) : NAN;
}

OffSkin off_skin(const std::vector<Eigen::Vector3d>& points, const TriangleMesh& skin, double more_than_mm) {
    constexpr double kFar_mm = 60, kOnSkin_mm = 0.5;
    OffSkin result;
    if (points.empty() || skin.triangles.empty()) return result;
    const TriangleMesh lids = not_skin(skin);
    const DistanceToMesh distance(skin);
    std::optional<DistanceToMesh> from_lid;
    if (!lids.triangles.empty()) from_lid.emplace(lids);
    for (const auto& p : points) {
        double mm = distance.within(p, more_than_mm);
        const bool off = !std::isfinite(mm);
        if (off) mm = distance.within(p, kFar_mm);
        if (mm > kOnSkin_mm && std::isfinite(mm) && from_lid && std::isfinite(from_lid->within(p, mm + kOnSkin_mm)))
            continue;
        ++result.asked;
        if (off) result.off.push_back(p);
    }
    return result;
}

}  // namespace planlight::test
