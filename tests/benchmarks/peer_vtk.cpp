#include <vtkCellArray.h>
#include <vtkIterativeClosestPointTransform.h>
#include <vtkLandmarkTransform.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include "tests/benchmarks/peer_matchers.h"

namespace planlight {
namespace {

vtkSmartPointer<vtkPolyData> poly_data_of(const std::vector<Eigen::Vector3d>& points) {
    vtkNew<vtkPoints> where;
    vtkNew<vtkCellArray> vertices;
    for (const auto& p : points) {
        const vtkIdType id = where->InsertNextPoint(p.data());
        vertices->InsertNextCell(1, &id);
    }
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(where);
    data->SetVerts(vertices);
    return data;
}

vtkSmartPointer<vtkPolyData> poly_data_of(const TriangleMesh& mesh) {
    auto data = poly_data_of(mesh.vertices_in_ct);
    vtkNew<vtkCellArray> triangles;
    for (const auto& t : mesh.triangles) {
        const vtkIdType corners[] = {t[0], t[1], t[2]};
        triangles->InsertNextCell(3, corners);
    }
    data->SetVerts(nullptr);
    data->SetPolys(triangles);
    return data;
}

}  // namespace

std::vector<PeerMatcher> vtk_icp(const PeerSkin& skin) {
    const auto target = poly_data_of(*skin.mesh);
    const auto icp = [target](const PointCloud& scan, const RigidTransform& start) {
        std::vector<Eigen::Vector3d> points;
        for (const auto& p : scan.points_in_rig) points.emplace_back(start * p);
        vtkNew<vtkIterativeClosestPointTransform> match;
        match->SetSource(poly_data_of(points));
        match->SetTarget(target);
        match->GetLandmarkTransform()->SetModeToRigidBody();
        match->SetMaximumNumberOfLandmarks(1000);
        match->SetMaximumNumberOfIterations(100);
        match->CheckMeanDistanceOn();
        match->SetMaximumMeanDistance(1e-5);
        match->Update();
        RigidTransform moved = RigidTransform::Identity();
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) moved.matrix()(i, j) = match->GetMatrix()->GetElement(i, j);
        return RigidTransform(moved * start);
    };
    return {{"vtkIterativeClosestPointTransform, 1000 landmarks", icp}};
}

}  // namespace planlight
