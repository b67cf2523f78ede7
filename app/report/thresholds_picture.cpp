#include "app/report/thresholds_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "app/report/slice_picture.h"
#include "planning_io/types/error.h"
#include "segmentation/skin_threshold.h"

namespace planlight {
namespace {

constexpr int kTile = 420, kTitle = 44;

TriangleMesh skin_at(const Volume& volume, SkinSettings settings, double threshold) {
    settings.threshold = threshold;
    try {
        return triangulate_skin(volume, segment_skin(volume, settings), settings);
    } catch (const InputError&) {
        return {};
    }
}

void put(const RgbImage& tile, int x0, int y0, RgbImage& sheet) {
    for (int y = 0; y < tile.height; ++y)
        std::copy_n(tile.pixels.begin() + static_cast<std::ptrdiff_t>(tile.index(0, y)), tile.width,
                    sheet.pixels.begin() + static_cast<std::ptrdiff_t>(sheet.index(x0, y0 + y)));
}

}  // namespace

RgbImage thresholds_picture(const Volume& volume, const SkinSettings& settings, double threshold) {
    RgbImage sheet(3 * kTile, 3 * kTile + kTitle, {10, 14, 26});
    const Eigen::Vector3d middle =
        volume.ct_from_voxel *
        Eigen::Vector3d(0.5 * volume.size[0] - 0.5, 0.5 * volume.size[1] - 0.5, 0.5 * volume.size[2] - 0.5);
    SliceSettings of_slice;
    of_slice.width = of_slice.height = kTile;
    int column = 0;
    for (const double factor : {kLowerThreshold, 1.0, kHigherThreshold}) {
        // The one found may change from place to place (MR): as it was taken; the others are one value everywhere.
        const TriangleMesh skin = skin_at(volume, settings, factor == 1.0 ? settings.threshold : factor * threshold);
        int row = 0;
        for (const SliceKind kind : {SliceKind::sagittal, SliceKind::coronal, SliceKind::axial})
            put(slice_picture(volume, skin, {}, kind, middle, of_slice), column * kTile, kTitle + kTile * row++, sheet);
        cv::Mat canvas(sheet.height, sheet.width, CV_8UC3, sheet.pixels.data());
        cv::putText(
            canvas,
            fmt::format("--threshold {}{}", threshold_text(factor * threshold), factor == 1.0 ? " (found)" : ""),
            {column++ * kTile + 12, 30}, cv::FONT_HERSHEY_SIMPLEX, 0.8, cv::Scalar(235, 235, 235), 2, cv::LINE_AA);
    }
    return sheet;
}

}  // namespace planlight
