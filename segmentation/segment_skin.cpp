#include "segmentation/segment_skin.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "planning_io/types/error.h"
#include "segmentation/detach_objects.h"
#include "segmentation/outside_air.h"
#include "segmentation/segment_mr_skin.h"
#include "segmentation/skin_threshold.h"

namespace planlight {
namespace {

constexpr double kLeastBody_ml = 50, kLeastPhantom_ml = 2;
constexpr double kLargeEnd_cm2 = 1, kComparable = 0.1;  // of a phantom

[[noreturn]] void refuse(const std::string& what, bool phantom = false) {
    throw InputError({}, (phantom ? "There is no phantom in the volume: " : "There is no skin in the volume: ") + what,
                     phantom ? "Check that the series shows it with air round it, or give another threshold."
                             : "Check that the series shows the head with air round it, or give another threshold.");
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

/// How much of a piece lies on both ends of the volume along an axis, square cm: the larger, the smaller.
std::pair<double, double> ends_cm2(const Mask& piece, const VoxelGrid& grid, int axis) {
    const auto& n = grid.size;
    std::array<std::size_t, 2> voxels{};
    std::size_t v = 0;
    for (int k = 0; k < n[2]; ++k)
        for (int j = 0; j < n[1]; ++j)
            for (int i = 0; i < n[0]; ++i, ++v) {
                const int at = axis == 0 ? i : axis == 1 ? j : k;
                if (at == 0) voxels[0] += piece[v];
                if (at == n[static_cast<std::size_t>(axis)] - 1) voxels[1] += piece[v];
            }
    const double cm2 = grid.voxel_ml() * 10 / grid.spacing_mm[axis];
    const auto [least, most] = std::minmax(voxels[0], voxels[1]);
    return {static_cast<double>(most) * cm2, static_cast<double>(least) * cm2};
}

/// Nothing is cut off a phantom: what may be a couch, or may lie on one, is said. A phantom that ends at one end of the
/// stack of slices alone is usual, as a neck does.
std::vector<std::string> doubts_of_phantom(const DetachedBody& whole, const Mask& dense, const VoxelGrid& grid) {
    std::vector<std::string> doubts;
    bool ends = false;
    for (int axis = 0; axis < 3; ++axis) {
        const auto [most_cm2, least_cm2] = ends_cm2(whole.body, grid, axis);
        ends = ends || (axis < 2 ? most_cm2 : least_cm2) > kLargeEnd_cm2;
    }
    if (ends)
        doubts.push_back(
            "the piece that was taken for the phantom reaches the sides of the volume, as a couch does: what touches "
            "it "
            "is part of the skin. Look at the skin, and raise the threshold or lay the phantom apart");
    Mask others = dense;
    for (std::size_t v = 0; v < others.size(); ++v) others[v] = others[v] && !whole.body[v];
    const auto taken = static_cast<double>(std::count(whole.body.begin(), whole.body.end(), 1));
    const auto second = static_cast<double>(largest_piece(std::move(others), grid).voxels);
    if (second > kComparable * taken)
        doubts.push_back(
            fmt::format("of two large pieces in the volume the larger was taken for the phantom ({:.0f} ml), and the "
                        "other left out ({:.0f} ml). Look at the skin: a couch may be the larger",
                        taken * grid.voxel_ml(), second * grid.voxel_ml()));
    return doubts;
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
    whole.warnings = doubts_of_phantom(whole, dense, grid);
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
    if (detached.body.empty())
        refuse(fmt::format("nothing {}is denser than {:.4g}", settings.phantom ? "" : "thick ", result.threshold),
               settings.phantom);
    report(0.6);

    result.body = outside_air_sealed(detached.body, grid, settings.seal_radius_mm);
    std::size_t voxels = 0;
    for (auto& v : result.body) voxels += v = !v;
    result.volume_ml = static_cast<double>(voxels) * grid.voxel_ml();
    if (voxels == result.body.size()) refuse("no air round the body", settings.phantom);
    if (result.volume_ml < (settings.phantom ? kLeastPhantom_ml : kLeastBody_ml))
        refuse(fmt::format("the largest piece denser than {:.4g} has {:.1f} ml", result.threshold, result.volume_ml),
               settings.phantom);

    result.pieces_removed = detached.pieces_removed;
    result.removed_ml = detached.removed_ml;
    result.warnings = std::move(detached.warnings);
    report(1);
    return result;
}

}  // namespace planlight
