#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "planning_io/types/image.h"
#include "planning_io/types/point_cloud.h"
#include "registration/scan/decode/decode_stripes.h"

// Small pictures for the pages: a cloud, a code map, a legend with its unit.
namespace planlight::scan_rooms {

/// 0 dark blue, 1 yellow (perceptually even, after viridis).
Rgb sequential_colour(double share);
/// 0 blue, 0.5 near white, 1 red.
Rgb signed_colour(double share);

/// Points as discs, the nearest in front, seen by a parallel view: `view_from_rig` has x right, y down, z away from the
/// eye; the cloud's middle is in the picture's. Shaded by the normals where there are any.
RgbImage draw_cloud(const PointCloud& cloud, const std::vector<Rgb>& colours, const Eigen::Matrix3d& view_from_rig,
                    double mm_per_px, int width, int height, int radius_px = 1);

/// The decoded columns by colour; grey where nothing is decoded. Every second pixel of larger pictures.
RgbImage draw_columns(const DecodedView& view, int projector_width);

/// A bar under the picture: `low` to `high` with words.
RgbImage with_legend(const RgbImage& picture, const std::string& words, double low, double high, Rgb (*colour)(double));

/// Words in the upper left corner.
void write_words(RgbImage& picture, const std::string& words, int x = 8, int y = 18);

RgbImage half_size(const RgbImage& picture);
RgbImage coloured(const GrayImage& picture);
/// Pictures of one size in rows of `columns`, with a gap.
RgbImage side_by_side(const std::vector<RgbImage>& pictures, int columns);

}  // namespace planlight::scan_rooms
