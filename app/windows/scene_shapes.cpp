#include "app/windows/scene_shapes.h"

#include <vtkAppendPolyData.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataNormals.h>
#include <vtkQuadricClustering.h>
#include <vtkTubeFilter.h>
#include <vtkUnsignedCharArray.h>

#include <cmath>
#include <map>
#include <numbers>

#include "app/windows/distance_colours.h"

namespace planlight {
namespace {

constexpr Rgb kSkinColour{232, 190, 165}, kLidColour{150, 140, 135}, kScanColour{150, 196, 214};
constexpr double kPlanRadiusMm = 0.9, kTextRadiusMm = 0.3, kLightRadiusMm = 0.3;
constexpr double kAboveSkinMm = 0.4;
constexpr std::size_t kMostPoints = 60000;
constexpr std::size_t kMostTriangles = 60000;  ///< of a risk structure

/// Coloured polygons or lines as they are collected.
struct Shape {
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> cells;
    vtkNew<vtkUnsignedCharArray> colours;

    Shape() { colours->SetNumberOfComponents(3); }
    vtkIdType add_point(const Eigen::Vector3d& p) { return points->InsertNextPoint(p.data()); }
    void add_colour(const Rgb& colour) { colours->InsertNextTypedTuple(colour.data()); }
    void begin_cell(const Rgb& colour) {
        cells->InsertNextCell(0);
        add_colour(colour);
        count = 0;
    }
    void add_to_cell(vtkIdType id) {
        cells->InsertCellPoint(id);
        cells->UpdateCellCount(++count);
    }
    int count = 0;
};

vtkSmartPointer<vtkPolyData> tubes(const Shape& lines, double radius_mm) {
    vtkNew<vtkPolyData> data;
    data->SetPoints(lines.points);
    data->SetLines(lines.cells);
    data->GetCellData()->SetScalars(lines.colours);
    vtkNew<vtkTubeFilter> tube;
    tube->SetInputData(data);
    tube->SetRadius(radius_mm);
    tube->SetNumberOfSides(6);
    tube->CappingOn();
    tube->Update();
    return tube->GetOutput();
}

bool drawable(const std::vector<Eigen::Vector3d>& points) {
    for (const Eigen::Vector3d& p : points)
        if (!p.allFinite()) return false;
    return points.size() >= 2;
}

/// Adds a line; points on the same place are left out, for a tube has no direction there.
void add_line(Shape& shape, const std::vector<Eigen::Vector3d>& points, bool closed, const Rgb& colour) {
    if (!drawable(points)) return;
    shape.begin_cell(colour);
    vtkIdType first = -1;
    const Eigen::Vector3d* last = nullptr;
    for (const Eigen::Vector3d& p : points) {
        if (last != nullptr && (p - *last).norm() < 1e-3) continue;
        const vtkIdType id = shape.add_point(p);
        if (first < 0) first = id;
        shape.add_to_cell(id);
        last = &p;
    }
    if (closed) shape.add_to_cell(first);
}

void add_disc(Shape& shape, const Eigen::Vector3d& centre, const Eigen::Vector3d& normal, double radius_mm,
              const Rgb& colour) {
    const Eigen::Vector3d u = normal.unitOrthogonal(), v = normal.cross(u);
    shape.begin_cell(colour);
    constexpr int kCorners = 32;
    for (int i = 0; i < kCorners; ++i) {
        const double angle = 2 * std::numbers::pi * i / kCorners;
        shape.add_to_cell(shape.add_point(centre + radius_mm * (std::cos(angle) * u + std::sin(angle) * v)));
    }
}

vtkSmartPointer<vtkPolyData> surface_of(const TriangleMesh& mesh) {
    vtkNew<vtkPoints> points;
    for (const Eigen::Vector3d& p : mesh.vertices_in_ct) points->InsertNextPoint(p.data());
    vtkNew<vtkCellArray> cells;
    for (const auto& t : mesh.triangles) {
        const vtkIdType ids[3] = {t[0], t[1], t[2]};
        cells->InsertNextCell(3, ids);
    }
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points);
    data->SetPolys(cells);
    return data;
}

/// The skin's own colour, or that of its predicted error; lids have none.
void add_vertex_colours(const SceneModel& scene, vtkPolyData& data) {
    const TriangleMesh& skin = *scene.skin;
    const std::vector<float>* errors = scene.skin_error_mm.get();
    vtkNew<vtkUnsignedCharArray> colours;
    colours->SetNumberOfComponents(3);
    colours->SetNumberOfTuples(static_cast<vtkIdType>(skin.vertices_in_ct.size()));
    for (std::size_t i = 0; i < skin.vertices_in_ct.size(); ++i) {
        const bool lid = i < skin.flags.size() && skin.flags[i] != kSkin;
        const bool known = errors != nullptr && i < errors->size();
        const Rgb colour =
            lid             ? kLidColour
            : known         ? error_colour(static_cast<double>((*errors)[i]), scene.warn_above_mm, scene.stop_above_mm)
            : scene.of_scan ? kScanColour
                            : kSkinColour;
        colours->SetTypedTuple(static_cast<vtkIdType>(i), colour.data());
    }
    data.GetPointData()->SetScalars(colours);
}

}  // namespace

vtkSmartPointer<vtkPolyData> skin_shape(const SceneModel& scene) {
    const TriangleMesh& skin = *scene.skin;
    vtkSmartPointer<vtkPolyData> data = surface_of(skin);
    add_vertex_colours(scene, *data);
    if (skin.normals_in_ct.size() == skin.vertices_in_ct.size()) {
        vtkNew<vtkFloatArray> normals;
        normals->SetNumberOfComponents(3);
        for (const Eigen::Vector3d& n : skin.normals_in_ct) normals->InsertNextTuple(n.data());
        data->GetPointData()->SetNormals(normals);
        return data;
    }
    vtkNew<vtkPolyDataNormals> normals;
    normals->SetInputData(data);
    normals->SplittingOff();
    normals->ConsistencyOff();
    normals->Update();
    return normals->GetOutput();
}

vtkSmartPointer<vtkPolyData> cloud_shape(const PointCloud& cloud, const std::vector<float>* distance_mm,
                                         double largest_mm) {
    Shape shape;
    const std::size_t step = cloud.size() / kMostPoints + 1;
    for (std::size_t i = 0; i < cloud.size(); i += step) {
        const bool known = distance_mm != nullptr && i < distance_mm->size();
        shape.begin_cell(known ? distance_colour((*distance_mm)[i], largest_mm) : Rgb{90, 200, 250});
        shape.add_to_cell(shape.add_point(cloud.points_in_rig[i]));
    }
    vtkNew<vtkPolyData> data;
    data->SetPoints(shape.points);
    data->SetVerts(shape.cells);
    data->GetCellData()->SetScalars(shape.colours);
    return data;
}

vtkSmartPointer<vtkPolyData> plan_shape(const PlanDrawing& plan, int bright_item) {
    constexpr double kOwn = 0.25;  // of a dim item's colour; the rest is skin
    Shape lines, text;
    const auto colour = [&](const Rgb& own, int item) {
        if (bright_item < 0 || item == bright_item) return own;
        Rgb shown;
        for (std::size_t c = 0; c < 3; ++c)
            shown[c] = static_cast<std::uint8_t>(kOwn * own[c] + 0.75 * (1 - kOwn) * kSkinColour[c]);
        return shown;
    };
    for (const Stroke& stroke : plan.strokes) {
        std::vector<Eigen::Vector3d> points = stroke.points_in_ct;
        for (std::size_t i = 0; i < points.size() && i < stroke.normals_in_ct.size(); ++i)
            points[i] += kAboveSkinMm * stroke.normals_in_ct[i];
        const bool fine = stroke.kind == StrokeKind::tick || stroke.kind == StrokeKind::check_mark;
        add_line(fine ? text : lines, points, stroke.closed, colour(stroke.colour, stroke.item));
    }
    for (const Label& label : plan.labels) {
        if (label.of_moment || label.field_normals_in_ct.empty()) continue;
        add_line(text, label.leader.points_in_ct, false, colour(label.colour, label.item));
        const Eigen::Vector3d up = kAboveSkinMm * label.field_normals_in_ct[label.field_normals_in_ct.size() / 2];
        for (const auto& sign : label.signs_in_ct)
            for (std::vector<Eigen::Vector3d> outline : sign) {
                for (Eigen::Vector3d& p : outline) p += up;
                add_line(text, outline, true, colour(label.colour, label.item));
            }
    }
    vtkNew<vtkAppendPolyData> all;
    all->AddInputData(tubes(lines, kPlanRadiusMm));
    all->AddInputData(tubes(text, kTextRadiusMm));
    all->Update();
    return all->GetOutput();
}

vtkSmartPointer<vtkPolyData> risk_shape(const std::vector<RiskStructure>& structures) {
    constexpr int kParts = 96;  // along each axis, of one that is too large to be turned quickly
    vtkNew<vtkAppendPolyData> all;
    for (std::size_t i = 0; i < structures.size(); ++i) {
        vtkSmartPointer<vtkPolyData> surface = surface_of(structures[i].surface);
        if (structures[i].surface.triangles.size() > kMostTriangles) {
            vtkNew<vtkQuadricClustering> coarser;
            coarser->SetInputData(surface);
            coarser->SetNumberOfDivisions(kParts, kParts, kParts);
            coarser->Update();
            surface = coarser->GetOutput();
        }
        vtkNew<vtkPolyDataNormals> normals;
        normals->SetInputData(surface);
        normals->SplittingOff();
        normals->ConsistencyOn();
        normals->AutoOrientNormalsOn();  // a file may have its triangles the other way round
        normals->Update();
        vtkNew<vtkPolyData> shape;
        shape->ShallowCopy(normals->GetOutput());
        vtkNew<vtkUnsignedCharArray> colours;
        colours->SetNumberOfComponents(3);
        const Rgb colour = risk_colour(i);
        for (vtkIdType k = 0; k < shape->GetNumberOfPoints(); ++k) colours->InsertNextTypedTuple(colour.data());
        shape->GetPointData()->SetScalars(colours);
        all->AddInputData(shape);
    }
    all->Update();
    return all->GetOutput();
}

vtkSmartPointer<vtkPolyData> light_shape(const std::vector<LightLine>& light) {
    Shape lines;
    for (const LightLine& line : light) add_line(lines, line.points_in_ct, line.closed, {255, 255, 255});
    return tubes(lines, kLightRadiusMm);
}

vtkSmartPointer<vtkPolyData> marker_shape(const std::vector<SceneMarker>& markers,
                                          const Eigen::Vector3d& middle_in_ct) {
    constexpr double kDiscMm = 4;
    Shape shape;
    for (const SceneMarker& marker : markers) {
        Eigen::Vector3d normal = marker.normal_in_ct;
        if (normal.norm() < 0.5) normal = marker.p_in_ct - middle_in_ct;
        normal.normalize();
        add_disc(shape, marker.p_in_ct + 0.6 * normal, normal, kStickerRadius_mm,
                 marker.seen ? Rgb{245, 245, 245} : Rgb{140, 140, 140});
        add_disc(shape, marker.p_in_ct + 1.0 * normal, normal, kDiscMm,
                 marker.seen ? Rgb{15, 15, 15} : Rgb{80, 80, 80});
    }
    vtkNew<vtkPolyData> data;
    data->SetPoints(shape.points);
    data->SetPolys(shape.cells);
    data->GetCellData()->SetScalars(shape.colours);
    return data;
}

}  // namespace planlight
