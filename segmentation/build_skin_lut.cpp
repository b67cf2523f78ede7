#include "segmentation/build_skin_lut.h"

#include <fmt/format.h>

#include <cmath>

#include "planning_io/types/error.h"
#include "segmentation/nearest_transform.h"
#include "segmentation/signed_distance_grid.h"
#include "segmentation/skin_voxels.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kMostBytes = 2.0 * 1024 * 1024 * 1024;
constexpr double kMostVoxelsAlongAxis = 16384;  // squared distances stay within 32 bits

void check(const TriangleMesh& skin, const LutSettings& settings) {
    if (skin.triangles.empty()) throw InputError({}, "The skin mesh has no triangles.", "Segment the skin first.");
    for (const auto& p : skin.vertices_in_ct)
        if (!p.allFinite())
            throw InputError({}, "The skin mesh has a vertex that is not a number.", "Make the mesh again.");
    for (const auto& t : skin.triangles)
        for (const auto corner : t)
            if (corner < 0 || static_cast<std::size_t>(corner) >= skin.vertices_in_ct.size())
                throw InputError({}, "A triangle of the skin mesh names a vertex that is not there.",
                                 "Make the mesh again.");
    if (!(settings.voxel_mm > 0) || !(settings.distance_voxel_mm > 0) || !(settings.margin_mm >= 0))
        throw InputError({}, "The voxels of the table must have a size and the margin must not be negative.",
                         "Give a voxel size above 0 mm.");
    if (settings.distance_voxel_mm > kExactBand_mm)
        throw InputError({}, fmt::format("A distance field of {} mm voxels is too coarse.", settings.distance_voxel_mm),
                         fmt::format("Give at most {} mm.", kExactBand_mm));
}

std::array<int, 3> size_for(const Vector3d& extent_mm, double voxel_mm) {
    const Vector3d n = (extent_mm / voxel_mm).array().ceil() + 1;
    if (!(n.maxCoeff() <= kMostVoxelsAlongAxis) || n.prod() * 4 > kMostBytes)
        throw InputError(
            {},
            fmt::format("The table would have {:.0f} x {:.0f} x {:.0f} voxels, more than 2 GiB.", n.x(), n.y(), n.z()),
            "Use larger voxels or a smaller margin.");
    return {static_cast<int>(n.x()), static_cast<int>(n.y()), static_cast<int>(n.z())};
}

}  // namespace

SkinLut build_skin_lut(const TriangleMesh& skin, const LutSettings& settings,
                       const std::function<void(double)>& progress) {
    const auto report = [&](double done) {
        if (progress) progress(done);
    };
    check(skin, settings);
    Vector3d low = Vector3d::Constant(INFINITY), high = -low;
    for (const auto& t : skin.triangles)
        for (const auto corner : t) {
            low = low.cwiseMin(skin.vertices_in_ct[static_cast<std::size_t>(corner)]);
            high = high.cwiseMax(skin.vertices_in_ct[static_cast<std::size_t>(corner)]);
        }
    SkinLut lut;
    lut.voxel_mm = settings.voxel_mm;
    lut.distance_voxel_mm = settings.distance_voxel_mm;
    lut.origin_in_ct = low - Vector3d::Constant(settings.margin_mm);
    const Vector3d extent_mm = high - low + Vector3d::Constant(2 * settings.margin_mm);
    lut.size = size_for(extent_mm, lut.voxel_mm);
    lut.distance_size = size_for(extent_mm, lut.distance_voxel_mm);

    mark_skin_voxels(skin, lut);
    report(0.2);
    point_to_nearest(lut);
    report(0.6);
    fill_signed_distance(skin, lut);
    report(1);
    return lut;
}

}  // namespace planlight
