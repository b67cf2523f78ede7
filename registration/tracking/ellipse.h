#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "planning_io/types/image.h"

namespace planlight {

/// An ellipse in a picture, pixels: the points x with (x - centre)^T shape^-1 (x - centre) = 1.
struct Ellipse {
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();
    Eigen::Matrix2d shape = Eigen::Matrix2d::Identity();  ///< squared half axes, turned; a circle has r^2 I

    /// Large, then small.
    Eigen::Vector2d half_axes() const;
    /// A matrix L with shape = L L^T: maps the unit circle to the ellipse (about its centre).
    Eigen::Matrix2d from_unit_circle() const;
    /// Signed distance to the ellipse, pixels, positive outside, to first order.
    double distance(const Eigen::Vector2d& pixel) const;
};

/// A circle in the picture, as an ellipse.
Ellipse circle(const Eigen::Vector2d& centre, double radius_px);

/// The ellipse through edge points, those far off left out (`used` says which were kept). Algebraic fit with A + C = 2.
/// Empty with fewer than 8 points, or when the conic is no ellipse.
std::optional<Ellipse> fit_ellipse_to_points(const std::vector<Eigen::Vector2d>& points, std::vector<bool>& used);

/// The ellipse to which the lines of equal brightness near `start` are tangent: the dual conic of the gradients
/// (Ouellet & Hebert 2009), two robust passes. `half_width_px` is the width of the band of pixels to either side.
/// Only gradients that point outwards (dark inside) count. Empty when the band leaves the picture or there is no
/// ellipse.
std::optional<Ellipse> fit_ellipse_to_gradients(const GrayImage& picture, const Ellipse& start, double half_width_px);

}  // namespace planlight
