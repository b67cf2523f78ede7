#include "planning_io/case/slicer_scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>
#include <vtkXMLPolyDataWriter.h>

#include "planning_io/case/slicer_transform.h"
#include "planning_io/files/json_value.h"
#include "planning_io/files/keep_to_owner.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/files/xml_text.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

void set_points(vtkPolyData* data, const std::vector<Vector3d>& points) {
    vtkNew<vtkPoints> list;
    list->SetDataTypeToDouble();
    for (const Vector3d& p : points) list->InsertNextPoint(p.data());
    data->SetPoints(list);
}

/// Slicer reads in which axes a file is from a field "SPACE".
void write_model(vtkPolyData* data, const fs::path& file) {
    vtkNew<vtkStringArray> space;
    space->SetName("SPACE");
    space->InsertNextValue("LPS");
    data->GetFieldData()->AddArray(space);
    vtkNew<vtkXMLPolyDataWriter> writer;
    writer->SetInputData(data);
    writer->SetDataModeToBinary();
    writer->WriteToOutputStringOn();
    writer->Write();
    write_safely(file, writer->GetOutputString());
}

void write_skin(const TriangleMesh& skin, const fs::path& file) {
    vtkNew<vtkPolyData> data;
    set_points(data, skin.vertices_in_ct);
    vtkNew<vtkCellArray> triangles;
    for (const auto& triangle : skin.triangles) {
        triangles->InsertNextCell(3);
        for (const auto vertex : triangle) triangles->InsertCellPoint(vertex);
    }
    data->SetPolys(triangles);
    write_model(data, file);
}

void write_cloud_points(const PointCloud& cloud, const fs::path& file) {
    vtkNew<vtkPolyData> data;
    set_points(data, cloud.points_in_rig);
    vtkNew<vtkCellArray> vertices;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        vertices->InsertNextCell(1);
        vertices->InsertCellPoint(static_cast<vtkIdType>(i));
    }
    data->SetVerts(vertices);
    if (cloud.sigma_mm.size() == cloud.size()) {
        vtkNew<vtkFloatArray> sigma;
        sigma->SetName("sigma_mm");
        for (const float mm : cloud.sigma_mm) sigma->InsertNextValue(mm);
        data->GetPointData()->AddArray(sigma);
    }
    write_model(data, file);
}

void write_light(const std::vector<SlicerLine>& light, const fs::path& file) {
    std::vector<Vector3d> points;
    vtkNew<vtkCellArray> lines;
    vtkNew<vtkUnsignedCharArray> colours;
    colours->SetName("colour");
    colours->SetNumberOfComponents(3);
    for (const SlicerLine& line : light) {
        const auto first = static_cast<vtkIdType>(points.size());
        lines->InsertNextCell(static_cast<int>(line.points_in_ct.size()) + (line.closed ? 1 : 0));
        for (std::size_t i = 0; i < line.points_in_ct.size(); ++i)
            lines->InsertCellPoint(first + static_cast<vtkIdType>(i));
        if (line.closed) lines->InsertCellPoint(first);
        points.insert(points.end(), line.points_in_ct.begin(), line.points_in_ct.end());
        colours->InsertNextTuple3(line.colour[0], line.colour[1], line.colour[2]);
    }
    vtkNew<vtkPolyData> data;
    set_points(data, points);
    data->SetLines(lines);
    data->GetCellData()->SetScalars(colours);
    write_model(data, file);
}

/// scene.mrml as it grows: each node with an id of its own.
class MrmlScene {
public:
    void add_transform(const std::string& name, const RigidTransform& lps, const std::string& file) {
        const Eigen::Matrix4d flip = Eigen::Vector4d(-1, -1, 1, 1).asDiagonal();
        const Eigen::Matrix4d ras = flip * lps.matrix() * flip;
        std::vector<std::string> numbers;
        for (Eigen::Index i = 0; i < 16; ++i) numbers.push_back(fmt::format("{:.17g}", ras(i / 4, i % 4)));
        text_ += fmt::format(
            " <LinearTransform id=\"{0}\" name=\"{1}\" storageNodeRef=\"vtkMRMLTransformStorageNode1\" "
            "references=\"storage:vtkMRMLTransformStorageNode1;\" matrixTransformToParent=\"{2}\" "
            "readWriteAsTransformToParent=\"true\" />\n"
            " <TransformStorage id=\"vtkMRMLTransformStorageNode1\" name=\"{1} file\" fileName=\"{3}\" />\n",
            kTransform, name, fmt::join(numbers, " "), file);
    }
    /// `look`: attributes of how it is displayed.
    void add_model(const std::string& name, const std::string& file, const std::string& look, bool in_rig = false) {
        const int n = ++models_;
        const std::string display = fmt::format("vtkMRMLModelDisplayNode{}", n),
                          storage = fmt::format("vtkMRMLModelStorageNode{}", n);
        text_ += fmt::format(
            " <Model id=\"vtkMRMLModelNode{0}\" name=\"{1}\" displayNodeRef=\"{2}\" storageNodeRef=\"{3}\"{4} "
            "references=\"display:{2};storage:{3};{5}\" />\n"
            " <ModelDisplay id=\"{2}\" name=\"{1} display\" visibility=\"true\" {6} />\n"
            " <ModelStorage id=\"{3}\" name=\"{1} file\" fileName=\"{7}\" coordinateSystem=\"LPS\" />\n",
            n, name, display, storage, in_rig ? fmt::format(" transformNodeRef=\"{}\"", kTransform) : "",
            in_rig ? fmt::format("transform:{};", kTransform) : "", look, file);
    }
    void add_markup(const std::string& name, const std::string& type, const std::string& file) {
        const int n = ++markups_;
        const std::string kind = type == "Plane" ? "MarkupsPlaneJsonStorage" : "MarkupsJsonStorage",
                          display = fmt::format("vtkMRMLMarkupsDisplayNode{}", n),
                          storage = fmt::format("vtkMRML{}Node{}", kind, n);
        text_ += fmt::format(
            " <Markups{0} id=\"vtkMRMLMarkups{0}Node{1}\" name=\"{2}\" displayNodeRef=\"{3}\" storageNodeRef=\"{4}\" "
            "references=\"display:{3};storage:{4};\" />\n"
            " <MarkupsDisplay id=\"{3}\" name=\"{2} display\" visibility=\"true\" />\n"
            " <{5} id=\"{4}\" name=\"{2} file\" fileName=\"{6}\" coordinateSystem=\"LPS\" />\n",
            type, n, xml_escaped(name), display, storage, kind, file);
    }
    std::string text() const {
        return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<MRML version=\"Slicer5\" userTags=\"\">\n" + text_ +
               "</MRML>\n";
    }

private:
    static constexpr const char* kTransform = "vtkMRMLLinearTransformNode1";
    std::string text_;
    int models_ = 0, markups_ = 0;
};

/// Slicer loads one markup of a file that a scene names: a file for each item.
void write_items(const Plan& plan, const fs::path& folder, MrmlScene& mrml) {
    int number = 0;
    const auto write = [&](const std::string& name, const Plan& one) {
        const std::string file = fmt::format("plan-{}.mrk.json", ++number);
        write_plan(one, folder / file);
        const Json json = parse_json(read_whole(folder / file), folder / file);
        mrml.add_markup(name, json.at("markups").at(0).at("type").get<std::string>(), file);
    };
    const auto each = [&](const auto& items, auto member) {
        for (const auto& item : items) {
            Plan one;
            (one.*member).push_back(item);
            write(item.name, one);
        }
    };
    each(plan.osteotomy_lines, &Plan::osteotomy_lines);
    each(plan.boreholes, &Plan::boreholes);
    each(plan.trajectories, &Plan::trajectories);
    each(plan.cut_planes, &Plan::cut_planes);
}

void fill(const SlicerScene& scene, const fs::path& folder) {
    MrmlScene mrml;
    write_slicer_transform(scene.ct_from_rig.inverse(), folder / "ct_from_rig.tfm");
    mrml.add_transform(scene.confirmed ? "ct_from_rig" : "ct_from_rig, NOT CONFIRMED", scene.ct_from_rig,
                       "ct_from_rig.tfm");
    if (!scene.skin.triangles.empty()) {
        write_skin(scene.skin, folder / "skin.vtp");
        mrml.add_model("skin", "skin.vtp", "color=\"0.86 0.72 0.64\" opacity=\"0.7\"");
    }
    if (!scene.cloud.empty()) {
        write_cloud_points(scene.cloud, folder / "cloud.vtp");
        mrml.add_model("scan", "cloud.vtp", "color=\"0.2 0.6 0.9\" pointSize=\"2\"", true);
    }
    if (!scene.light.empty()) {
        write_light(scene.light, folder / "light.vtp");
        mrml.add_model("plan on the skin", "light.vtp",
                       "color=\"0.1 0.9 0.3\" lineWidth=\"3\" scalarVisibility=\"true\" activeScalarName=\"colour\" "
                       "activeAttributeLocation=\"cell\" scalarRangeFlag=\"UseDirectMapping\"");
    }
    write_items(scene.plan, folder, mrml);
    write_safely(folder / "scene.mrml", mrml.text());
}

}  // namespace

void write_slicer_scene(const SlicerScene& scene, const fs::path& folder) {
    write_folder_safely(folder, false, [&](const fs::path& into) {
        keep_to_owner(into);  // the skin is a face
        fill(scene, into);
        keep_to_owner(into);
    });
}

}  // namespace planlight
