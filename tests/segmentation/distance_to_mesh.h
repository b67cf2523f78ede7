#pragma once

#include <Eigen/Core>
#include <memory>

#include "planning_io/types/triangle_mesh.h"

namespace planlight::test {

/// Distances from the nearest triangle of a mesh, mm, as VTK finds them.
class DistanceToMesh {
public:
    explicit DistanceToMesh(const TriangleMesh& mesh);
    ~DistanceToMesh();
    double operator()(const Eigen::Vector3d& p) const;
    /// The distance where it is at most `most_mm`, else infinite: much sooner found.
    double within(const Eigen::Vector3d& p, double most_mm) const;

private:
    struct Locator;
    std::unique_ptr<Locator> locator_;
};

}  // namespace planlight::test
