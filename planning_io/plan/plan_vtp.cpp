#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkXMLPolyDataWriter.h>

#include <Eigen/Geometry>

#include "planning_io/files/safe_write.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/plan/plan_settings.h"
#include "planning_io/plan/plan_shapes.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

/// Lines and points with a row of cell data each. Points come first: so does VTK number its cells.
class PlanCells {
public:
    PlanCells() {
        points_->SetDataTypeToDouble();
        for (vtkDoubleArray* array : {axes_.Get(), colours_.Get()}) array->SetNumberOfComponents(3);
        kinds_->SetName("kind");
        names_->SetName("name");
        descriptions_->SetName("description");
        axes_->SetName("axis");
        colours_->SetName("colour");
    }
    void add(const char* kind, const std::string& name, const std::string& description,
             const std::vector<Vector3d>& points, bool closed, const std::optional<Colour>& colour,
             const std::optional<Vector3d>& axis = std::nullopt) {
        const vtkIdType first = points_->GetNumberOfPoints();
        for (const auto& p : points) points_->InsertNextPoint(p.data());
        vtkCellArray* cells = points.size() == 1 ? verts_.Get() : lines_.Get();
        cells->InsertNextCell(static_cast<int>(points.size()) + (closed ? 1 : 0));
        for (std::size_t i = 0; i < points.size(); ++i) cells->InsertCellPoint(first + static_cast<vtkIdType>(i));
        if (closed) cells->InsertCellPoint(first);
        kinds_->InsertNextValue(kind);
        names_->InsertNextValue(name);
        descriptions_->InsertNextValue(description);
        const Vector3d a = axis.value_or(Vector3d::Zero());
        axes_->InsertNextTuple3(a.x(), a.y(), a.z());
        const auto c = colour.value_or(Colour{-1, -1, -1});  // -1: none given
        colours_->InsertNextTuple3(static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2]));
    }
    std::string as_vtp() {
        vtkNew<vtkPolyData> data;
        data->SetPoints(points_);
        data->SetVerts(verts_);
        data->SetLines(lines_);
        for (vtkAbstractArray* array : std::initializer_list<vtkAbstractArray*>{
                 kinds_.Get(), names_.Get(), descriptions_.Get(), axes_.Get(), colours_.Get()})
            data->GetCellData()->AddArray(array);
        vtkNew<vtkStringArray> space;
        space->SetName("SPACE");
        space->InsertNextValue("LPS");
        data->GetFieldData()->AddArray(space);
        vtkNew<vtkXMLPolyDataWriter> writer;
        writer->SetInputData(data);
        writer->SetDataModeToBinary();  // decimal text would round
        writer->SetCompressorTypeToNone();
        writer->WriteToOutputStringOn();
        writer->Write();
        return writer->GetOutputString();
    }

private:
    vtkNew<vtkPoints> points_;
    vtkNew<vtkCellArray> verts_, lines_;
    vtkNew<vtkStringArray> kinds_, names_, descriptions_;
    vtkNew<vtkDoubleArray> axes_, colours_;
};

std::vector<Vector3d> corners_of(const CutPlane& c) {
    const Vector3d u = c.first_axis_in_ct * c.width_mm / 2,
                   v = c.normal_in_ct.cross(c.first_axis_in_ct) * c.height_mm / 2;
    return {c.origin_in_ct - u - v, c.origin_in_ct + u - v, c.origin_in_ct + u + v, c.origin_in_ct - u + v};
}

}  // namespace

void write_plan_vtp(const Plan& plan, const std::filesystem::path& file) {
    check_plan_numbers(plan, file);
    PlanCells cells;
    for (const auto& b : plan.boreholes)
        cells.add("borehole", b.name, description_of(b), {b.position_in_ct}, false, b.colour, b.axis_in_ct);
    for (const auto& t : plan.trajectories)
        cells.add("trajectory", t.name, description_of(t), {t.entry_in_ct, t.target_in_ct}, false, t.colour);
    for (const auto& o : plan.osteotomy_lines)
        cells.add("osteotomy_line", o.name, "", o.points_in_ct, o.closed, o.colour);
    for (const auto& c : plan.cut_planes) cells.add("cut_plane", c.name, "", corners_of(c), true, c.colour);
    write_safely(file, cells.as_vtp());
}

}  // namespace planlight
