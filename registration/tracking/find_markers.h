#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "planning_io/types/image.h"

namespace planlight {

/// A pasted marker: a matte black disc on a white round sticker.
struct MarkerDesign {
    double disc_diameter_mm = 8, sticker_diameter_mm = 16;
};

/// A marker's disc as one camera sees it.
struct MarkerObservation {
    Eigen::Vector2d pixel;  ///< centre of the ellipse
    double radius_px = 0;   ///< mean of the half axes
    double axis_ratio = 1;  ///< small / large half axis
    double sigma_px = 0;    ///< one standard deviation of the centre
    double steady_px = 0;   ///< the part of `sigma_px` that is the same in every picture while the head does not turn
    double contrast = 0;    ///< grey values across the edge
};

/// What a disc must look like to be a marker's.
struct MarkerSettings {
    double min_radius_px = 3, max_radius_px = 60;
    double min_contrast = 12;  ///< grey values
    double min_axis_ratio = 0.35;
    double max_fit_residual_px = 0.35;
    double max_bend = 0.025;   ///< or this share of the radius, if more: a sticker on bent skin is no exact ellipse
    double sticker_ratio = 2;  ///< diameter of the white sticker / diameter of the disc
    double min_ring_step =
        0.04;  ///< how much darker than the sticker the skin round it is, as a fraction of the contrast
};

/// All markers in a picture: found by the Hough transform (Hoppe 2001, 2.2 [7]), measured by a sub-pixel ellipse fit on
/// the gradients (dual conic). Empty when there is none; no order.
std::vector<MarkerObservation> find_markers(const GrayImage& picture, const MarkerSettings& settings = {});

/// One marker near a predicted place, for tracking: empty when there is no disc of about `radius_px` within
/// `search_px`.
std::optional<MarkerObservation> measure_marker(const GrayImage& picture, const Eigen::Vector2d& near_pixel,
                                                double radius_px, double search_px,
                                                const MarkerSettings& settings = {});

}  // namespace planlight
