#include "tests/segmentation/distance_to_mesh.h"

#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStaticCellLocator.h>

#include <cmath>

namespace planlight::test {

struct DistanceToMesh::Locator {
    vtkNew<vtkPolyData> surface;
    vtkNew<vtkStaticCellLocator> cells;
};

DistanceToMesh::DistanceToMesh(const TriangleMesh& mesh) : locator_(std::make_unique<Locator>()) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (const auto& p : mesh.vertices_in_ct) points->InsertNextPoint(p.data());
    vtkNew<vtkCellArray> cells;
    for (const auto& t : mesh.triangles) {
        const vtkIdType ids[3] = {t[0], t[1], t[2]};
        cells->InsertNextCell(3, ids);
    }
    locator_->surface->SetPoints(points);
    locator_->surface->SetPolys(cells);
    locator_->cells->SetDataSet(locator_->surface);
    locator_->cells->BuildLocator();
}

DistanceToMesh::~DistanceToMesh() = default;

double DistanceToMesh::operator()(const Eigen::Vector3d& p) const {
    double closest[3], squared = 0;
    vtkIdType cell = 0;
    int part = 0;
    locator_->cells->FindClosestPoint(p.data(), closest, cell, part, squared);
    return std::sqrt(squared);
}

double DistanceToMesh::within(const Eigen::Vector3d& p, double most_mm) const {
    double closest[3], squared = 0, at[3] = {p.x(), p.y(), p.z()};
    vtkIdType cell = 0;
    int part = 0;
    if (locator_->cells->FindClosestPointWithinRadius(at, most_mm, closest, cell, part, squared) <= 0) return INFINITY;
    return std::sqrt(squared);
}

}  // namespace planlight::test
