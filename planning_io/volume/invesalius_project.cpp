#include "planning_io/volume/invesalius_project.h"

#include <plist/plist.h>
#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkCellArrayIterator.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string_view>

#include "planning_io/files/header_text.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/project_archive.h"
#include "planning_io/volume/volume_checks.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using Entries = std::map<std::string, std::string>;
using PlistOwner = std::unique_ptr<void, void (*)(plist_t)>;

constexpr const char* kSaveAgain = "Open the project in InVesalius 3 and save it again.";
constexpr std::uint64_t kAxial = 1;
constexpr std::uint64_t kMemoryTimes = 5;  ///< int16 as they are stored, as float, and that on its way to the parent
constexpr double kPerpendicular = 1e-3;

[[noreturn]] void damaged(const fs::path& file, const std::string& problem) {
    throw DamagedFileError(file, problem, kSaveAgain);
}

PlistOwner parse_plist(const Entries& entries, const std::string& name, const fs::path& file) {
    const auto entry = entries.find(name);
    if (entry == entries.end()) damaged(file, "holds no " + name);
    const std::string& text = entry->second;
    std::size_t containers = 0;  // libplist walks its tree by recursion
    for (std::size_t at = 0; (at = text.find("<", at)) != std::string::npos; ++at) {
        const std::string_view tag = std::string_view(text).substr(at, 6);
        containers += tag.starts_with("<dict") || tag == "<array";
    }
    if (text.size() > (1 << 20) || containers > 2000) damaged(file, name + " is larger than a project's can be");
    plist_t root = nullptr;
    plist_from_xml(text.data(), static_cast<std::uint32_t>(text.size()), &root);
    PlistOwner owner(root, plist_free);
    if (!root || plist_get_node_type(root) != PLIST_DICT) damaged(file, name + " is not a property list");
    return owner;
}

/// The value at `key`, which must be there.
plist_t value_of(plist_t dictionary, const char* key, const fs::path& file) {
    plist_t value =
        dictionary && plist_get_node_type(dictionary) == PLIST_DICT ? plist_dict_get_item(dictionary, key) : nullptr;
    if (!value) damaged(file, std::string("its property list has no \"") + key + "\"");
    return value;
}

std::string text_of(plist_t value, const char* key, const fs::path& file) {
    if (plist_get_node_type(value) != PLIST_STRING)
        damaged(file, std::string("\"") + key + "\" in its property list is not a text");
    char* text = nullptr;
    plist_get_string_val(value, &text);
    const std::string result = text ? text : "";
    std::free(text);
    return result;
}

std::array<double, 3> three_numbers(plist_t value, const char* key, const fs::path& file) {
    if (plist_get_node_type(value) != PLIST_ARRAY || plist_array_get_size(value) != 3)
        damaged(file, std::string("\"") + key + "\" in its property list is not three numbers");
    std::array<double, 3> numbers{};
    for (std::uint32_t i = 0; i < 3; ++i) {
        plist_t item = plist_array_get_item(value, i);
        if (plist_get_node_type(item) == PLIST_REAL) {
            plist_get_real_val(item, &numbers[i]);
        } else if (plist_get_node_type(item) == PLIST_UINT) {
            std::uint64_t whole = 0;
            plist_get_uint_val(item, &whole);
            numbers[i] = static_cast<double>(whole);
        } else {
            damaged(file, std::string("\"") + key + "\" in its property list is not three numbers");
        }
    }
    return numbers;
}

struct MatrixHeader {
    std::string file_name, modality, name;
    std::array<int, 3> size{};  ///< along x, y (rows), z
    std::array<double, 3> spacing_mm{};
};

/// Only slices of axial DICOM stand in the matrix with x to the left and rows to anterior. What comes from NIfTI stands
/// half a turn from that, and says that it is coronal (InVesalius: imagedata_utils.img2memmap,
/// control.CreateOtherProject); the slices of coronal and sagittal DICOM stand in the order of their files.
void check_axial(plist_t main, const fs::path& file) {
    plist_t orientation = value_of(main, "orientation", file), affine = plist_dict_get_item(main, "affine");
    if (plist_get_node_type(orientation) != PLIST_UINT)
        damaged(file, "\"orientation\" in its property list is not a number");
    std::uint64_t along = 0;
    plist_get_uint_val(orientation, &along);
    const bool has_affine = affine && plist_get_node_type(affine) == PLIST_ARRAY && plist_array_get_size(affine) > 0;
    if (along != kAxial || has_affine)
        throw InputError(file,
                         "was imported from NIfTI, or from sagittal or coronal slices: its axes are not those of "
                         "axial slices",
                         "Give the NIfTI file or the DICOM series itself.");
}

/// "CT" or "MR".
std::string modality_of(plist_t main, const fs::path& file) {
    const std::string modality = text_of(value_of(main, "modality", file), "modality", file);
    if (modality == "CT") return modality;
    if (modality.starts_with("MR")) return "MR";
    throw InputError(file,
                     "is of modality \"" + modality +
                         "\", neither CT nor MR: a project made from pictures does not say which side is left",
                     "Give the DICOM series itself.");
}

MatrixHeader read_header(const Entries& entries, const fs::path& file) {
    const PlistOwner main = parse_plist(entries, "main.plist", file);
    check_axial(main.get(), file);
    plist_t matrix = value_of(main.get(), "matrix", file);
    MatrixHeader header;
    header.file_name = fs::path(text_of(value_of(matrix, "filename", file), "filename", file)).filename().string();
    const std::string type = text_of(value_of(matrix, "dtype", file), "dtype", file);
    if (type != "int16")
        throw InputError(file, "its matrix is of type " + type + ", not int16",
                         "Import the slices into InVesalius again, or give their DICOM folder.");
    const auto shape = three_numbers(value_of(matrix, "shape", file), "shape", file);  // z, y, x
    header.spacing_mm = three_numbers(value_of(main.get(), "spacing", file), "spacing", file);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double count = shape[2 - axis], spacing = header.spacing_mm[axis];
        if (!(count >= 2) || !(count <= 4096) || count != std::floor(count))
            damaged(file, "the shape of its matrix makes no sense");
        if (!(spacing > 0.01) || !(spacing < 50)) damaged(file, "the spacing of its matrix makes no sense");
        header.size[axis] = static_cast<int>(count);
    }
    header.modality = modality_of(main.get(), file);
    plist_t name = plist_dict_get_item(main.get(), "name");
    if (name && plist_get_node_type(name) == PLIST_STRING) header.name = text_of(name, "name", file);
    return header;
}

bool is_plist(const std::string& name) {
    return name.ends_with(".plist");
}

/// Triangles of polygons (of three corners) or of triangle strips. False when a corner is none of the `points`.
bool add_triangles(vtkCellArray& cells, bool strips, vtkIdType points, TriangleMesh& mesh) {
    const auto cell = vtk::TakeSmartPointer(cells.NewIterator());
    for (cell->GoToFirstCell(); !cell->IsDoneWithTraversal(); cell->GoToNextCell()) {
        vtkIdType count = 0;
        const vtkIdType* ids = nullptr;
        cell->GetCurrentCell(count, ids);
        for (vtkIdType c = 0; c < count; ++c)
            if (ids[c] < 0 || ids[c] >= points) return false;
        if (!strips && count != 3) continue;
        for (vtkIdType c = 0; c + 2 < count; ++c) {
            const vtkIdType odd = c % 2;  // every second triangle of a strip is wound the other way
            mesh.triangles.push_back({static_cast<std::int32_t>(ids[c]), static_cast<std::int32_t>(ids[c + 1 + odd]),
                                      static_cast<std::int32_t>(ids[c + 2 - odd])});
        }
    }
    return true;
}

}  // namespace

Volume read_invesalius_volume(const fs::path& file) {
    static const std::string kUsualName = "matrix.dat";
    const auto read = [&](const std::function<bool(const std::string&)>& wanted) {
        return read_tar_entries(file, wanted, kMemoryTimes);
    };
    Entries entries = read([](const std::string& name) { return is_plist(name) || name == kUsualName; });
    const MatrixHeader header = read_header(entries, file);
    const auto [nx, ny, nz] = header.size;
    const auto [sx, sy, sz] = header.spacing_mm;
    Volume volume;
    volume.size = header.size;
    volume.ct_from_voxel = Eigen::Translation3d(0, -sy * (ny - 1), 0) * Eigen::Scaling(sx, sy, sz);
    check_grid(volume, file, kPerpendicular);
    check_not_defaced(file, header.name);
    if (header.file_name != kUsualName)
        entries.merge(read([&](const std::string& name) { return name == header.file_name; }));
    const auto matrix = entries.find(header.file_name);
    if (matrix == entries.end()) damaged(file, "holds no matrix");
    const auto row = static_cast<std::size_t>(nx), rows = static_cast<std::size_t>(ny),
               slices = static_cast<std::size_t>(nz);
    if (matrix->second.size() != row * rows * slices * sizeof(std::int16_t))
        damaged(file, "its matrix does not have the size its shape says");

    volume.modality = header.modality;
    volume.source = "InVesalius project " + file.filename().string();
    volume.values.resize(row * rows * slices);
    for (std::size_t k = 0; k < slices; ++k)
        for (std::size_t j = 0; j < rows; ++j) {
            const char* from = matrix->second.data() + ((k * rows + (rows - 1 - j)) * row) * sizeof(std::int16_t);
            float* to = volume.values.data() + (k * rows + j) * row;
            for (std::size_t i = 0; i < row; ++i) {
                const auto low = static_cast<unsigned char>(from[2 * i]),
                           high = static_cast<unsigned char>(from[2 * i + 1]);
                to[i] = static_cast<std::int16_t>(static_cast<std::uint16_t>(low | (high << 8)));
            }
        }
    volume.is_hu = volume.modality == "CT" && has_air_in_hu(volume);
    return volume;
}

std::vector<TriangleMesh> read_invesalius_surfaces(const fs::path& file) {
    const Entries entries =
        read_tar_entries(file, [](const std::string& name) { return is_plist(name) || name.ends_with(".vtp"); });
    std::vector<TriangleMesh> surfaces;
    for (const auto& [name, text] : entries) {
        if (!name.starts_with("surface_") || !is_plist(name)) continue;
        const PlistOwner surface = parse_plist(entries, name, file);
        const std::string mesh_name =
            fs::path(text_of(value_of(surface.get(), "polydata", file), "polydata", file)).filename().string();
        const auto mesh_entry = entries.find(mesh_name);
        if (mesh_entry == entries.end()) damaged(file, "holds no " + mesh_name);

        vtkNew<vtkXMLPolyDataReader> reader;
        bool failed = false;
        vtkNew<vtkCallbackCommand> on_error;
        on_error->SetClientData(&failed);
        on_error->SetCallback([](vtkObject*, unsigned long, void* flag, void*) { *static_cast<bool*>(flag) = true; });
        reader->AddObserver("ErrorEvent", on_error);
        reader->SetParserErrorObserver(on_error);
        reader->SetReaderErrorObserver(on_error);
        reader->ReadFromInputStringOn();
        reader->SetInputString(mesh_entry->second);
        reader->Update();
        vtkPolyData* data = reader->GetOutput();
        if (failed || !data || !data->GetPoints()) damaged(file, mesh_name + " is damaged");
        TriangleMesh mesh;  // (x, -y, z) of the matrix is ct as read_invesalius_volume has it
        const vtkIdType points = data->GetNumberOfPoints();
        for (vtkIdType i = 0; i < points; ++i)
            mesh.vertices_in_ct.emplace_back(Eigen::Map<Eigen::Vector3d>(data->GetPoint(i)));
        for (vtkCellArray* const cells : {data->GetPolys(), data->GetStrips()})
            if (!add_triangles(*cells, cells == data->GetStrips(), points, mesh))
                damaged(file, mesh_name + " is damaged");
        surfaces.push_back(std::move(mesh));
    }
    return surfaces;
}

}  // namespace planlight
