// Legacy VTK and VTP, by VTK's readers in a child process.
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataReader.h>
#include <vtkStringArray.h>
#include <vtkTriangleFilter.h>
#include <vtkXMLPolyDataReader.h>

#include "planning_io/files/safe_write.h"
#include "planning_io/files/sandboxed_process.h"
#include "planning_io/surface/shape_file.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr const char* kCopyAgain = "Export or copy the file again.";

std::string text_of(vtkFieldData* data, const char* name, vtkIdType row) {
    auto* array = vtkStringArray::SafeDownCast(data->GetAbstractArray(name));
    return array && row < array->GetNumberOfValues() ? std::string(array->GetValue(row)) : std::string();
}

std::optional<std::array<double, 3>> three_of(vtkFieldData* data, const char* name, vtkIdType row) {
    auto* array = data->GetArray(name);
    if (!array || array->GetNumberOfComponents() != 3 || row >= array->GetNumberOfTuples()) return std::nullopt;
    std::array<double, 3> values{};
    array->GetTuple(row, values.data());
    return values;
}

/// The cells of one array, with what the cell data say of them; `first` is the number of its first cell in the cell
/// data.
void put_lines(Parcel& parcel, vtkCellArray* cells, vtkFieldData* data, vtkIdType first) {
    for (vtkIdType c = 0; c < cells->GetNumberOfCells(); ++c) {
        vtkIdType count = 0;
        const vtkIdType* points = nullptr;
        cells->GetCellAtId(c, count, points);
        parcel.put(std::vector<std::int32_t>(points, points + count));
        for (const char* name : {"kind", "name", "description"}) parcel.put(text_of(data, name, first + c));
        const auto axis = three_of(data, "axis", first + c), colour = three_of(data, "colour", first + c);
        for (const auto& values : {axis, colour}) {
            parcel.put(values.has_value());
            parcel.put(values.value_or(std::array<double, 3>{}));
        }
    }
}

void put_poly_data(Parcel& parcel, vtkPolyData* data, const fs::path& file) {
    if (!data || data->GetNumberOfPoints() == 0) throw InputError(file, "holds no points", kCopyAgain);
    std::vector<double> coordinates;
    for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i) {
        const double* p = data->GetPoint(i);
        coordinates.insert(coordinates.end(), p, p + 3);
    }
    parcel.put(coordinates);
    const vtkIdType verts = data->GetVerts()->GetNumberOfCells(), lines = data->GetLines()->GetNumberOfCells();
    parcel.put(static_cast<std::uint64_t>(verts + lines));
    put_lines(parcel, data->GetVerts(), data->GetCellData(), 0);
    put_lines(parcel, data->GetLines(), data->GetCellData(), verts);
    vtkNew<vtkTriangleFilter> triangles;  // of polygons and strips
    triangles->SetInputData(data);
    triangles->PassVertsOff();
    triangles->PassLinesOff();
    triangles->Update();
    std::vector<std::array<std::int32_t, 3>> corners;
    vtkCellArray* cells = triangles->GetOutput()->GetPolys();
    for (vtkIdType c = 0; c < cells->GetNumberOfCells(); ++c) {
        vtkIdType count = 0;
        const vtkIdType* points = nullptr;
        cells->GetCellAtId(c, count, points);
        if (count == 3)
            corners.push_back({static_cast<std::int32_t>(points[0]), static_cast<std::int32_t>(points[1]),
                               static_cast<std::int32_t>(points[2])});
    }
    parcel.put(corners);
}

template <class Reader>
void parse(Parcel& parcel, const fs::path& file) {
    vtkNew<Reader> reader;
    reader->SetFileName(file.c_str());
    reader->Update();
    if (reader->GetErrorCode() != 0) throw DamagedFileError(file, "is damaged or cut short", kCopyAgain);
    vtkPolyData* data = vtkPolyData::SafeDownCast(reader->GetOutput());
    parcel.put(data ? text_of(data->GetFieldData(), "SPACE", 0) : std::string());
    put_poly_data(parcel, data, file);
}

/// The title, which is the second line of a legacy file: where 3D Slicer writes SPACE=LPS.
std::string title_of(const fs::path& file) {
    const std::string content = read_whole(file);
    if (!content.starts_with("# vtk DataFile Version")) throw DamagedFileError(file, "is not a VTK file", kCopyAgain);
    const auto first = content.find('\n'), second = content.find('\n', first + 1);
    return second == std::string::npos ? std::string() : content.substr(first + 1, second - first - 1);
}

}  // namespace

Shape parse_vtk_in_child(const fs::path& file, bool xml) {
    const std::string title = xml ? std::string() : title_of(file);
    Parcel parcel = parse_in_child(file, {"VTK file"}, [&](Parcel& p) {
        xml ? parse<vtkXMLPolyDataReader>(p, file) : parse<vtkPolyDataReader>(p, file);
    });
    Shape shape;
    const std::string field = parcel.get_text();
    shape.space = space_of_mesh(field.empty() ? title : "SPACE=" + field, file);
    const auto coordinates = parcel.get_list<double>();
    for (std::size_t i = 0; i + 2 < coordinates.size(); i += 3)
        shape.points.emplace_back(coordinates[i], coordinates[i + 1], coordinates[i + 2]);
    const auto lines = parcel.get<std::uint64_t>();
    for (std::uint64_t i = 0; i < lines; ++i) {
        ShapeLine line;
        line.points = parcel.get_list<std::int32_t>();
        line.kind = parcel.get_text();
        line.name = parcel.get_text();
        line.description = parcel.get_text();
        const bool has_axis = parcel.get<bool>();
        const auto axis = parcel.get<std::array<double, 3>>();
        const bool has_colour = parcel.get<bool>();
        const auto colour = parcel.get<std::array<double, 3>>();
        if (has_axis && Vector3d(axis[0], axis[1], axis[2]).norm() > 0.5)
            line.axis = Vector3d(axis[0], axis[1], axis[2]);
        if (has_colour && colour[0] >= 0)
            line.colour =
                Colour{static_cast<float>(colour[0]), static_cast<float>(colour[1]), static_cast<float>(colour[2])};
        shape.lines.push_back(std::move(line));
    }
    shape.triangles = parcel.get_list<std::array<std::int32_t, 3>>();
    return shape;
}

}  // namespace planlight
