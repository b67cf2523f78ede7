#pragma once

#include <Eigen/Core>
#include <functional>
#include <random>
#include <vector>

#include "planning_io/types/triangle_mesh.h"

namespace planlight::test {

/// How high a sheet lies over the view's plane at (x, y), mm; not a number where there is none.
using Height = std::function<double(double, double)>;

/// A sheet over a square of `width_mm` about the origin of the view's frame, sampled every `edge_mm`.
TriangleMesh sheet_mesh(const Height& height, double width_mm, double edge_mm);
/// A pipe along a line of points, with a radius at each; its ends are round.
TriangleMesh pipe_mesh(const std::vector<Eigen::Vector3d>& line, const std::vector<double>& radius_mm);
/// A box with edges along the columns of `axes`.
TriangleMesh box_mesh(const Eigen::Vector3d& middle, const Eigen::Matrix3d& axes, const Eigen::Vector3d& size_mm);
void append(const TriangleMesh& part, TriangleMesh& to);

/// Waves of several lengths between two limits, directions and phases drawn; about `height_mm` rms in all.
class Folds {
public:
    Folds(double shortest_mm, double longest_mm, double height_mm, std::mt19937& random);
    double operator()(double x, double y) const;

private:
    struct Wave {
        double kx, ky, phase, height_mm;
    };
    std::vector<Wave> waves_;
};

}  // namespace planlight::test
