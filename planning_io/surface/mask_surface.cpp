#include "planning_io/surface/mask_surface.h"

#include <vtkCellArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPolyData.h>

#include <algorithm>

namespace planlight {
namespace {

constexpr int kRim = 2;  // empty voxels all round, so that the surface is closed

void smooth(float* values, std::size_t all, std::size_t stride) {
    std::vector<float> before(stride, 0.0F);  // as they were
    for (std::size_t i = stride; i + stride < all; ++i) {
        const float lower = before[i % stride];
        before[i % stride] = values[i];
        values[i] = 0.25F * lower + 0.5F * values[i] + 0.25F * values[i + stride];
    }
}

void fill(vtkImageData* image, const MaskStack& mask) {
    std::array<std::size_t, 3> n{}, wide{};
    for (std::size_t a = 0; a < 3; ++a) n[a] = static_cast<std::size_t>(mask.size[a]), wide[a] = n[a] + 2 * kRim;
    image->SetDimensions(static_cast<int>(wide[0]), static_cast<int>(wide[1]), static_cast<int>(wide[2]));
    image->SetOrigin(-kRim, -kRim, -kRim);
    image->AllocateScalars(VTK_FLOAT, 1);
    auto* values = static_cast<float*>(image->GetScalarPointer());
    const std::size_t row = wide[0], slab = row * wide[1], all = slab * wide[2];
    std::fill(values, values + all, 0.0F);
    for (std::size_t k = 0; k < n[2]; ++k)
        for (std::size_t j = 0; j < n[1]; ++j)
            for (std::size_t i = 0; i < n[0]; ++i)
                values[(k + kRim) * slab + (j + kRim) * row + i + kRim] = mask.inside[(k * n[1] + j) * n[0] + i];
    for (const std::size_t stride : {std::size_t{1}, row, slab}) smooth(values, all, stride);
}

}  // namespace

TriangleMesh surface_of_mask(const MaskStack& mask) {
    vtkNew<vtkImageData> image;
    fill(image, mask);
    vtkNew<vtkFlyingEdges3D> surface;
    surface->SetInputData(image);
    surface->SetValue(0, 0.5);
    surface->ComputeNormalsOff();
    surface->ComputeGradientsOff();
    surface->ComputeScalarsOff();
    surface->Update();
    vtkPolyData* data = surface->GetOutput();
    TriangleMesh mesh;
    for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i) {
        const double* v = data->GetPoint(i);
        mesh.vertices_in_ct.push_back(mask.ct_from_voxel * Eigen::Vector3d(v[0], v[1], v[2]));
    }
    for (vtkIdType c = 0; c < data->GetPolys()->GetNumberOfCells(); ++c) {
        vtkIdType count = 0;
        const vtkIdType* p = nullptr;
        data->GetPolys()->GetCellAtId(c, count, p);
        if (count == 3 && p[0] != p[1] && p[1] != p[2] && p[2] != p[0])
            mesh.triangles.push_back(
                {static_cast<std::int32_t>(p[0]), static_cast<std::int32_t>(p[1]), static_cast<std::int32_t>(p[2])});
    }
    return mesh;
}

}  // namespace planlight
