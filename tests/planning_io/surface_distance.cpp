#include "tests/planning_io/surface_distance.h"

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStaticCellLocator.h>

#include <algorithm>
#include <vector>

namespace planlight::test {
namespace {

/// The iso-surface, found in voxels and carried to ct point by point, so that a sheared grid stays exact.
vtkSmartPointer<vtkPolyData> surface_of(const Volume& volume, double level) {
    vtkNew<vtkFloatArray> values;
    values->SetArray(const_cast<float*>(volume.values.data()), static_cast<vtkIdType>(volume.values.size()), 1);
    vtkNew<vtkImageData> image;
    image->SetDimensions(volume.size[0], volume.size[1], volume.size[2]);
    image->GetPointData()->SetScalars(values);
    vtkNew<vtkFlyingEdges3D> edges;
    edges->SetInputData(image);
    edges->SetValue(0, level);
    edges->ComputeNormalsOff();
    edges->Update();
    vtkSmartPointer<vtkPolyData> surface = edges->GetOutput();
    for (vtkIdType p = 0; p < surface->GetNumberOfPoints(); ++p) {
        const Eigen::Vector3d in_ct = volume.ct_from_voxel * Eigen::Map<Eigen::Vector3d>(surface->GetPoint(p));
        surface->GetPoints()->SetPoint(p, in_ct.data());
    }
    surface->GetPoints()->Modified();
    surface->ComputeBounds();
    return surface;
}

bool inside(const Volume& volume, const Eigen::Vector3d& p_in_ct) {
    const Eigen::Vector3d voxel = volume.ct_from_voxel.inverse() * p_in_ct;
    for (int a = 0; a < 3; ++a)
        if (!(voxel[a] >= 1) || !(voxel[a] <= volume.size[static_cast<std::size_t>(a)] - 2)) return false;
    return true;
}

}  // namespace

SurfaceDistance surface_distance(const Volume& a, const Volume& b, double level) {
    const auto from = surface_of(a, level), to = surface_of(b, level);
    vtkNew<vtkStaticCellLocator> locator;
    locator->SetDataSet(to);
    locator->BuildLocator();
    std::vector<double> distances;
    const vtkIdType step = std::max<vtkIdType>(1, from->GetNumberOfPoints() / 40000);
    for (vtkIdType p = 0; p < from->GetNumberOfPoints(); p += step) {
        const Eigen::Vector3d point(from->GetPoint(p));
        if (!inside(b, point)) continue;
        double closest[3], squared = 0;
        vtkIdType cell = -1;
        int part = 0;
        locator->FindClosestPoint(point.data(), closest, cell, part, squared);
        distances.push_back(std::sqrt(squared));
    }
    std::sort(distances.begin(), distances.end());
    if (distances.empty()) return {};
    return {distances[distances.size() / 2], distances[distances.size() * 9 / 10], static_cast<int>(distances.size())};
}

}  // namespace planlight::test
