#include "registration/simulation/iso_mesh.h"

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkIdList.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

namespace planlight::simulation {

IsoMesh iso_mesh(const CtField& field) {
    vtkNew<vtkFloatArray> scalars;
    scalars->SetArray(const_cast<float*>(field.values().data()), static_cast<vtkIdType>(field.values().size()), 1);
    vtkNew<vtkImageData> image;
    image->SetDimensions(field.size()[0], field.size()[1], field.size()[2]);
    image->GetPointData()->SetScalars(scalars);
    vtkNew<vtkFlyingEdges3D> contour;
    contour->SetInputData(image);
    contour->SetValue(0, 0.0);
    contour->ComputeNormalsOff();
    contour->ComputeGradientsOff();
    contour->ComputeScalarsOff();
    contour->Update();
    vtkPolyData* surface = contour->GetOutput();

    IsoMesh mesh;
    const vtkIdType count = surface->GetNumberOfPoints();
    std::vector<bool> outer(static_cast<std::size_t>(count));
    for (vtkIdType v = 0; v < count; ++v) {
        const Eigen::Vector3d p = field.ct_from_voxel() * Eigen::Map<const Eigen::Vector3d>(surface->GetPoint(v));
        mesh.vertices_in_ct.push_back(p.cast<float>());
        mesh.normals_in_ct.push_back((-field.smooth_gradient(p)).normalized().cast<float>());
        outer[static_cast<std::size_t>(v)] = field.next_to_room_air(p);
    }
    vtkNew<vtkIdList> ids;
    vtkCellArray* cells = surface->GetPolys();
    for (vtkIdType c = 0; c < cells->GetNumberOfCells(); ++c) {
        cells->GetCellAtId(c, ids);
        std::array<std::uint32_t, 3> t{};
        bool faces_room = false;
        for (int i = 0; i < 3; ++i) {
            t[static_cast<std::size_t>(i)] = static_cast<std::uint32_t>(ids->GetId(i));
            faces_room = faces_room || outer[t[static_cast<std::size_t>(i)]];
        }
        if (faces_room) mesh.triangles.push_back(t);
    }
    return mesh;
}

}  // namespace planlight::simulation
