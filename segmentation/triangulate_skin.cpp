#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "planning_io/types/error.h"
#include "segmentation/blank_places.h"
#include "segmentation/blanked_edges.h"
#include "segmentation/ct_greys.h"
#include "segmentation/decimate_skin.h"
#include "segmentation/fill_tunnels.h"
#include "segmentation/mr_skin_edge.h"
#include "segmentation/segment_skin.h"
#include "segmentation/skin_field.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr int kProfileRounds = 2;  // of means along the skin, for each smoothing that the mask needed

/// The crossing of the field, all pieces; vertices in field voxels.
TriangleMesh contour(SkinField& field) {
    vtkNew<vtkFloatArray> values;
    values->SetArray(field.values.data(), static_cast<vtkIdType>(field.values.size()), 1);
    vtkNew<vtkImageData> image;
    image->SetDimensions(field.size[0], field.size[1], field.size[2]);
    image->GetPointData()->SetScalars(values);
    vtkNew<vtkFlyingEdges3D> edges;
    edges->SetInputData(image);
    edges->SetValue(0, static_cast<double>(field.threshold));
    edges->ComputeNormalsOff();
    edges->ComputeScalarsOff();
    edges->Update();
    vtkPolyData* surface = edges->GetOutput();
    TriangleMesh mesh;
    mesh.vertices_in_ct.resize(static_cast<std::size_t>(surface->GetNumberOfPoints()));
    for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i)
        surface->GetPoint(i, mesh.vertices_in_ct[static_cast<std::size_t>(i)].data());
    vtkIdType count = 0;
    const vtkIdType* corners = nullptr;
    vtkCellArray* cells = surface->GetPolys();
    for (cells->InitTraversal(); cells->GetNextCell(count, corners);)
        mesh.triangles.push_back({static_cast<std::int32_t>(corners[0]), static_cast<std::int32_t>(corners[1]),
                                  static_cast<std::int32_t>(corners[2])});
    return mesh;
}

/// The piece with most triangles, its vertices renumbered.
TriangleMesh largest_shell(const TriangleMesh& mesh) {
    std::vector<std::int32_t> parent(mesh.vertices_in_ct.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](std::int32_t v) {
        while (parent[static_cast<std::size_t>(v)] != v) {
            auto& up = parent[static_cast<std::size_t>(v)];
            up = parent[static_cast<std::size_t>(up)];
            v = up;
        }
        return v;
    };
    for (const auto& t : mesh.triangles) {
        const std::int32_t a = root(t[0]);
        parent[static_cast<std::size_t>(root(t[1]))] = a;
        parent[static_cast<std::size_t>(root(t[2]))] = a;
    }
    std::vector<std::size_t> sizes(parent.size(), 0);
    for (const auto& t : mesh.triangles) ++sizes[static_cast<std::size_t>(root(t[0]))];
    const auto outer = static_cast<std::int32_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
    TriangleMesh shell;
    std::vector<std::int32_t> new_index(parent.size(), -1);
    for (auto t : mesh.triangles) {
        if (root(t[0]) != outer) continue;
        for (auto& corner : t) {
            auto& index = new_index[static_cast<std::size_t>(corner)];
            if (index < 0) {
                index = static_cast<std::int32_t>(shell.vertices_in_ct.size());
                shell.vertices_in_ct.push_back(mesh.vertices_in_ct[static_cast<std::size_t>(corner)]);
            }
            corner = index;
        }
        shell.triangles.push_back(t);
    }
    return shell;
}

/// Of a closed mesh of one piece.
bool has_handles(const TriangleMesh& mesh) {
    return mesh.vertices_in_ct.size() != mesh.triangles.size() / 2 + 2;
}

/// Flags and outward normals (unit, in ct) from the field; vertices exactly on their grid edge, still in field voxels.
void describe_vertices(TriangleMesh& mesh, const Volume& volume, const SkinMask& mask, const SkinField& field) {
    const Eigen::Matrix3d normal_from_gradient = -volume.ct_from_voxel.linear().inverse().transpose();
    mesh.flags.resize(mesh.vertices_in_ct.size());
    mesh.normals_in_ct.resize(mesh.vertices_in_ct.size());
    for (std::size_t i = 0; i < mesh.vertices_in_ct.size(); ++i) {
        Vector3d& p = mesh.vertices_in_ct[i];
        Vector3d nearest = p.array().round();
        int axis = 0;
        (p - nearest).cwiseAbs().maxCoeff(&axis);
        Eigen::Vector3i a = nearest.cast<int>();
        a[axis] = static_cast<int>(std::floor(p[axis]));
        Eigen::Vector3i b = a;
        ++b[axis];
        const double low = field.at(a.x(), a.y(), a.z()), high = field.at(b.x(), b.y(), b.z());
        nearest[axis] = a[axis] + (field.threshold - low) / (high - low);
        p = nearest;
        mesh.flags[i] = flag_of_edge(volume, mask, a, b);
        mesh.normals_in_ct[i] = (normal_from_gradient * gradient(field, p)).normalized();
    }
}

std::vector<Vector3d> area_normals(const TriangleMesh& mesh) {
    std::vector<Vector3d> normals(mesh.vertices_in_ct.size(), Vector3d::Zero());
    for (const auto& t : mesh.triangles) {
        const auto& a = mesh.vertices_in_ct[static_cast<std::size_t>(t[0])];
        const Vector3d n = (mesh.vertices_in_ct[static_cast<std::size_t>(t[1])] - a)
                               .cross(mesh.vertices_in_ct[static_cast<std::size_t>(t[2])] - a);
        for (const auto corner : t) normals[static_cast<std::size_t>(corner)] += n;
    }
    for (auto& n : normals) n.normalize();
    return normals;
}

/// Lids come out of whole voxels, in steps: they are drawn smooth between their rims, which stay (Laplace, 20 rounds).
void smooth_lids(TriangleMesh& mesh) {
    std::vector<Vector3d> sum(mesh.vertices_in_ct.size());
    std::vector<int> count(mesh.vertices_in_ct.size());
    for (int round = 0; round < 20; ++round) {
        std::fill(sum.begin(), sum.end(), Vector3d::Zero());
        std::fill(count.begin(), count.end(), 0);
        for (const auto& t : mesh.triangles)
            for (std::size_t c = 0; c < 3; ++c) {
                const auto v = static_cast<std::size_t>(t[c]);
                if (mesh.flags[v] != kSeal) continue;
                sum[v] += mesh.vertices_in_ct[static_cast<std::size_t>(t[(c + 1) % 3])];
                ++count[v];
            }
        for (std::size_t v = 0; v < sum.size(); ++v)
            if (count[v] > 0) mesh.vertices_in_ct[v] = 0.5 * mesh.vertices_in_ct[v] + 0.5 * sum[v] / count[v];
    }
}

/// Where the field's gradient is no normal (lids, ends, thin folds), the triangles decide.
void mend_normals(TriangleMesh& mesh) {
    const std::vector<Vector3d> by_area = area_normals(mesh);
    for (std::size_t v = 0; v < by_area.size(); ++v)
        if (mesh.flags[v] != kSkin || !(mesh.normals_in_ct[v].dot(by_area[v]) > 0.5))
            mesh.normals_in_ct[v] = by_area[v];
}

/// Where noise was smoothed away the profiles are taken as the scanner made them, and averaged along the skin: smoothed
/// across it, a thin edge would lie outside by half a millimetre and more.
void find_edges(TriangleMesh& mesh, const Volume& given, const Volume& smoothed, const SkinMask& mask) {
    EdgeSettings settings;
    settings.profile_rounds = kProfileRounds * mask.smoothings;
    if (mask.smoothings == 0)
        move_to_edges(mesh, smoothed, mask.threshold, settings);
    else
        move_to_edges(mesh, leveled_values(given, mask), mask.threshold, settings);
}

}  // namespace

TriangleMesh triangulate_skin(const Volume& given, const SkinMask& mask, const SkinSettings& settings,
                              const std::function<void(double)>& progress) {
    const auto report = [&](double done) {
        if (progress) progress(done);
    };
    if (mask.body.size() != given.values.size())
        throw InputError({}, "The skin mask is not that of the volume.", "Segment this volume again.");
    const Volume leveled = mask.levels.empty() ? Volume() : skin_values(given, mask);
    const Volume& volume = mask.levels.empty() ? given : leveled;
    SkinField field = skin_field(volume, mask);
    TriangleMesh mesh = largest_shell(contour(field));
    if (mesh.triangles.empty()) throw InputError({}, "The mask holds no body.", "Segment the volume again.");
    report(0.3);
    SkinMask filled;
    if (has_handles(mesh)) {
        filled.threshold = mask.threshold;
        filled.body = fill_tunnels(mask.body, grid_of(volume));
        field = skin_field(volume, filled);
        mesh = largest_shell(contour(field));
    }
    describe_vertices(mesh, volume, filled.body.empty() ? mask : filled, field);
    const bool mirrored = volume.ct_from_voxel.linear().determinant() < 0;
    for (auto& p : mesh.vertices_in_ct) p = volume.ct_from_voxel * (p - Vector3d::Ones());
    if (mirrored)
        for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    flag_blanked_edges(mesh, given, mask.threshold_said);
    if (mask.blank) flag_ends_at_blank(mesh, given, *mask.blank);
    smooth_lids(mesh);
    mend_normals(mesh);
    if (volume.modality == "MR") find_edges(mesh, given, volume, mask);
    report(0.5);
    TriangleMesh result = decimate_skin(mesh, settings.max_edge_mm, settings.max_decimation_error_mm);
    report(0.9);
    ThicknessSettings thickness = settings.thickness;
    thickness.bone_hu = ct_greys(volume, mask).of(thickness.bone_hu);
    result.thickness_mm = skin_thickness(volume, result, thickness);
    report(1);
    return result;
}

}  // namespace planlight
