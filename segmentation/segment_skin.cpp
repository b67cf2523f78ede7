#include "segmentation/segment_skin.h"

#include <fmt/format.h>

#include <algorithm>

#include "planning_io/types/error.h"
#include "segmentation/detach_objects.h"
#include "segmentation/outside_air.h"
#include "segmentation/segment_mr_skin.h"
#include "segmentation/skin_threshold.h"

namespace planlight {
namespace {

constexpr double kLeastBody_ml = 50;

[[noreturn]] void refuse(const std::string& what) {
    throw InputError({}, "There is no skin in the volume: " + what,
                     "Check that the series shows the head with air round it, or give another threshold.");
}

void check(const Volume& volume, const SkinSettings& settings) {
    const VoxelGrid grid = grid_of(volume);
    for (const int n : volume.size)
        if (n < 3) refuse("it has fewer than three voxels along an axis");
    if (volume.values.size() != grid.count()) refuse("its values do not fill it");
    if (!(grid.spacing_mm.minCoeff() > 0) || !grid.spacing_mm.allFinite()) refuse("its voxels have no size");
    if (!(settings.seal_radius_mm >= 0) || !(settings.detach_radius_mm >= 0))
        throw InputError({}, "a radius of the skin settings is negative", "Give radii of 0 mm or more.");
}

/// The largest piece, thin or thick, with nothing cut off it: a dry skull is thin, and its insert is its thickest part.
DetachedBody whole_phantom(const Mask& dense, const VoxelGrid& grid) {
    DetachedBody whole;
    LargestPiece piece = largest_piece(dense, grid);
    if (piece.voxels == 0) return whole;
    whole.body = std::move(piece.mask);
    whole.pieces_removed = piece.pieces - 1;
    const auto all = static_cast<std::size_t>(std::count(dense.begin(), dense.end(), 1));
    whole.removed_ml = static_cast<double>(all - piece.voxels) * grid.voxel_ml();
    return whole;
}

}  // namespace

SkinMask segment_skin(const Volume& volume, const SkinSettings& settings, const std::function<void(double)>& progress) {
    const auto report = [&](double done) {
        if (progress) progress(done);
    };
    check(volume, settings);
    if (volume.modality == "MR") return segment_mr_skin(volume, settings, progress);
    const VoxelGrid grid = grid_of(volume);
    SkinMask result;
    result.threshold = result.threshold_said =
        settings.threshold != 0 ? settings.threshold : skin_threshold(volume, settings.phantom);
    Mask dense(grid.count());
    for (std::size_t i = 0; i < dense.size(); ++i) dense[i] = volume.values[i] >= static_cast<float>(result.threshold);
    report(0.1);

    DetachedBody detached =
        settings.phantom ? whole_phantom(dense, grid)
                         : detach_objects(dense, volume.values, result.threshold, grid, settings.detach_radius_mm);
    if (detached.body.empty()) refuse(fmt::format("nothing thick is denser than {:.4g}", result.threshold));
    report(0.6);

    result.body = outside_air_sealed(detached.body, grid, settings.seal_radius_mm);
    std::size_t voxels = 0;
    for (auto& v : result.body) voxels += v = !v;
    result.volume_ml = static_cast<double>(voxels) * grid.voxel_ml();
    if (voxels == result.body.size()) refuse("no air round the body");
    if (result.volume_ml < kLeastBody_ml)
        refuse(fmt::format("the largest piece denser than {:.4g} has {:.1f} ml", result.threshold, result.volume_ml));

    result.pieces_removed = detached.pieces_removed;
    result.removed_ml = detached.removed_ml;
    result.warnings = std::move(detached.warnings);
    report(1);
    return result;
}

}  // namespace planlight
