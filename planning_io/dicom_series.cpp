#include "planning_io/dicom_series.h"

#include <fmt/format.h>
#include <vtkDICOMDictionary.h>
#include <vtkDICOMDirectory.h>
#include <vtkDICOMMetaData.h>
#include <vtkDICOMReader.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkIntArray.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkStringArray.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <set>
#include <vector>

#include "planning_io/dicom_slices.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr int kScanDepth = 4;
constexpr const char* kCopyAgain = "Copy or export the series again.";

std::string trimmed(std::string text) {
    while (!text.empty() && (text.back() == ' ' || text.back() == '\0')) text.pop_back();
    return text;
}

std::string text_at(vtkDICOMMetaData* meta, int file, vtkDICOMTag tag) { return trimmed(meta->Get(file, tag).AsString()); }

/// DICOM files that the directory left out because it could not read them: a series must not lose slices in silence.
void check_nothing_was_skipped(vtkDICOMDirectory* directory, const fs::path& folder) {
    std::set<fs::path> known;
    for (int s = 0; s < directory->GetNumberOfSeries(); ++s) {
        vtkStringArray* names = directory->GetFileNamesForSeries(s);
        for (vtkIdType i = 0; i < names->GetNumberOfValues(); ++i) known.insert(fs::weakly_canonical(std::string(names->GetValue(i))));
    }
    for (auto entry = fs::recursive_directory_iterator(folder, fs::directory_options::skip_permission_denied); entry != fs::recursive_directory_iterator(); ++entry) {
        if (entry.depth() >= kScanDepth - 1) entry.disable_recursion_pending();
        if (!entry->is_regular_file() || entry->path().filename() == "DICOMDIR" || known.contains(fs::weakly_canonical(entry->path()))) continue;
        std::array<char, 132> head{};
        std::ifstream in(entry->path(), std::ios::binary);
        if (in.read(head.data(), head.size()) && std::string(head.data() + 128, 4) == "DICM" && fs::file_size(entry->path()) < (1 << 24))
            throw DamagedFileError(entry->path(), "is a DICOM file that cannot be read", kCopyAgain);
    }
}

struct Series {
    int index = 0;
    std::string uid, modality, description;
    std::size_t files = 0;
};

std::vector<Series> list_series(vtkDICOMDirectory* directory) {
    std::vector<Series> list;
    for (int s = 0; s < directory->GetNumberOfSeries(); ++s) {
        vtkDICOMMetaData* meta = directory->GetMetaDataForSeries(s);
        list.push_back({s, text_at(meta, 0, DC::SeriesInstanceUID), text_at(meta, 0, DC::Modality), text_at(meta, 0, DC::SeriesDescription),
                        static_cast<std::size_t>(directory->GetFileNamesForSeries(s)->GetNumberOfValues())});
    }
    return list;
}

bool holds_file(vtkDICOMDirectory* directory, int series, const fs::path& file) {
    vtkStringArray* names = directory->GetFileNamesForSeries(series);
    for (vtkIdType i = 0; i < names->GetNumberOfValues(); ++i) {
        std::error_code ignored;
        if (fs::equivalent(std::string(names->GetValue(i)), file, ignored)) return true;
    }
    return false;
}

std::string table_of(const std::vector<Series>& list) {
    std::string table;
    for (const Series& s : list) table += fmt::format("\n  {}  {}  \"{}\"  {} file(s)", s.uid, s.modality, s.description, s.files);
    return table;
}

Series choose_series(vtkDICOMDirectory* directory, const fs::path& path, const std::string& wanted_uid) {
    const std::vector<Series> all = list_series(directory);
    std::vector<Series> fitting;
    for (const Series& s : all) {
        const bool named = wanted_uid.empty() ? fs::is_directory(path) || holds_file(directory, s.index, path) : s.uid == wanted_uid;
        if (named && (s.modality == "CT" || s.modality == "MR")) fitting.push_back(s);
    }
    if (all.empty()) throw InputError(path, "holds no DICOM images", "Name the folder of a CT or MR series, or an InVesalius project (.inv3).");
    if (fitting.empty()) throw InputError(path, (wanted_uid.empty() ? "holds no CT or MR series; there is:" : "holds no CT or MR series of that UID; there is:") + table_of(all),
                                          "Name the folder of a CT or MR series.");
    if (fitting.size() > 1) throw InputError(path, "holds several series:" + table_of(fitting), "Choose one by its UID (--series UID).");
    return fitting.front();
}

DicomSlice slice_of(vtkDICOMMetaData* meta, int file, int frame, const std::string& name, const fs::path& folder) {
    const auto numbers = [&](vtkDICOMTag tag, unsigned count, const char* what) {
        const vtkDICOMValue& value = meta->Get(file, frame, tag);
        std::array<double, 6> list{};
        if (value.GetNumberOfValues() < count) throw InputError(folder, fmt::format("{} has no {}", name, what), "Give a series of slices with positions in space.");
        for (unsigned i = 0; i < count; ++i) list[i] = value.GetDouble(i);
        return list;
    };
    DicomSlice slice;
    slice.file = name;
    const auto position = numbers(DC::ImagePositionPatient, 3, "position (Image Position, Patient)");
    const auto orientation = numbers(DC::ImageOrientationPatient, 6, "orientation (Image Orientation, Patient)");
    const auto spacing = numbers(DC::PixelSpacing, 2, "pixel spacing");
    slice.position_in_ct = {position[0], position[1], position[2]};
    slice.row_direction = {orientation[0], orientation[1], orientation[2]};
    slice.column_direction = {orientation[3], orientation[4], orientation[5]};
    slice.row_spacing_mm = spacing[0];
    slice.column_spacing_mm = spacing[1];
    slice.rows = meta->Get(file, DC::Rows).AsInt();
    slice.columns = meta->Get(file, DC::Columns).AsInt();
    slice.frame_of_reference_uid = text_at(meta, file, DC::FrameOfReferenceUID);
    slice.patient = text_at(meta, file, DC::PatientID) + "\\" + text_at(meta, file, DC::PatientName);
    return slice;
}

/// Of every file and frame, in the order of the files; checked.
std::vector<std::vector<DicomSlice>> checked_slices(vtkDICOMMetaData* meta, vtkStringArray* names, const fs::path& path) {
    std::vector<std::vector<DicomSlice>> by_file;
    std::vector<DicomSlice> all;
    for (int file = 0; file < meta->GetNumberOfInstances(); ++file) {
        const std::string name = fs::path(std::string(names->GetValue(file))).filename().string();
        if (meta->Get(file, DC::SamplesPerPixel).AsInt() != 1) throw InputError(path, name + " is a colour picture, not a slice", "Give a CT or MR series.");
        const int frames = std::clamp(meta->Get(file, DC::NumberOfFrames).AsInt(), 1, 100000);
        by_file.emplace_back();
        for (int frame = 0; frame < frames; ++frame)
            by_file.back().push_back(slice_of(meta, file, frame, frames > 1 ? fmt::format("{} frame {}", name, frame + 1) : name, path));
        all.insert(all.end(), by_file.back().begin(), by_file.back().end());
    }
    if (const auto fault = fault_of(all)) throw InputError(path, fault->problem, fault->remedy);
    return by_file;
}

/// The slices in the reader's order.
std::vector<DicomSlice> in_order(vtkDICOMReader* reader, const std::vector<std::vector<DicomSlice>>& by_file, const fs::path& path) {
    vtkIntArray *files = reader->GetFileIndexArray(), *frames = reader->GetFrameIndexArray();
    std::vector<DicomSlice> slices;
    std::size_t expected = 0;
    for (const auto& list : by_file) expected += list.size();
    for (vtkIdType s = 0; files && s < files->GetNumberOfTuples(); ++s) {
        const auto file = static_cast<std::size_t>(files->GetComponent(s, 0));
        const auto frame = frames && frames->GetNumberOfTuples() > s ? static_cast<std::size_t>(frames->GetComponent(s, 0)) : 0;
        slices.push_back(by_file.at(file).at(frame));
    }
    if (slices.size() != expected || (files && files->GetNumberOfComponents() != 1))
        throw InputError(path, fmt::format("its {} pictures do not stack to one volume ({} slices)", expected, slices.size()), "Export one series of one time point.");
    return slices;
}

/// The affine from the slices' own positions must agree with vtk-dicom's reading of them: two readings, one geometry.
void check_against_reader(vtkDICOMReader* reader, const Eigen::Affine3d& ct_from_voxel, const std::array<int, 3>& size, const fs::path& path) {
    const double* spacing = reader->GetOutput()->GetSpacing();
    for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector3d voxel((corner & 1) * (size[0] - 1), ((corner >> 1) & 1) * (size[1] - 1), (corner >> 2) * (size[2] - 1));
        const std::array<double, 4> in{voxel.x() * spacing[0], voxel.y() * spacing[1], voxel.z() * spacing[2], 1};
        std::array<double, 4> out{};
        reader->GetPatientMatrix()->MultiplyPoint(in.data(), out.data());
        if (!((ct_from_voxel * voxel - Eigen::Vector3d(out[0], out[1], out[2])).norm() < 0.1))
            throw DamagedFileError(path, "two readings of its geometry disagree by more than 0.1 mm", kCopyAgain);
    }
}

/// Slices in reverse order, so that a left-handed stack becomes right-handed.
void reverse_k(Volume& volume) {
    const auto slab = static_cast<std::ptrdiff_t>(volume.index(0, 0, 1));
    const int last = volume.size[2] - 1;
    for (int k = 0; k < last - k; ++k) {
        const auto low = volume.values.begin() + k * slab;
        std::swap_ranges(low, low + slab, volume.values.begin() + (last - k) * slab);
    }
    volume.ct_from_voxel.translation() += last * volume.ct_from_voxel.linear().col(2);
    volume.ct_from_voxel.linear().col(2) *= -1;
}

void copy_values(vtkImageData* image, Volume& volume, const fs::path& path) {
    vtkDataArray* scalars = image->GetPointData()->GetScalars();
    const auto count = volume.index(0, 0, volume.size[2]);
    if (!scalars || scalars->GetNumberOfComponents() != 1 || static_cast<std::size_t>(scalars->GetNumberOfTuples()) != count)
        throw DamagedFileError(path, "its pictures could not be unpacked", kCopyAgain);
    volume.values.resize(count);
    for (std::size_t i = 0; i < count; ++i) volume.values[i] = static_cast<float>(scalars->GetComponent(static_cast<vtkIdType>(i), 0));
}

/// Slope 1, intercept 0 and nothing below zero in a CT: stored values without their unit, not HU.
bool values_are_hu(vtkDICOMMetaData* meta, const Volume& volume) {
    if (volume.modality != "CT") return false;
    const std::string type = text_at(meta, 0, DC::RescaleType);
    if (!type.empty() && type != "HU") return false;
    for (int file = 0; file < meta->GetNumberOfInstances(); ++file)
        if (const auto& intercept = meta->Get(file, 0, DC::RescaleIntercept); intercept.IsValid() && intercept.AsDouble() != 0) return true;
    return *std::min_element(volume.values.begin(), volume.values.end()) < 0;
}

}  // namespace

Volume parse_dicom_series(const fs::path& path, const std::string& series_uid) {
    const bool is_folder = fs::is_directory(path);
    const fs::path folder = is_folder ? path : path.has_parent_path() ? path.parent_path() : fs::path(".");
    vtkNew<vtkDICOMDirectory> directory;
    directory->SetDirectoryName(folder.c_str());
    directory->SetScanDepth(is_folder ? kScanDepth : 1);
    directory->Update();
    if (is_folder) check_nothing_was_skipped(directory, folder);
    const Series series = choose_series(directory, path, series_uid);

    vtkNew<vtkDICOMReader> reader;
    vtkStringArray* names = directory->GetFileNamesForSeries(series.index);
    reader->SetFileNames(names);
    reader->SetMemoryRowOrderToFileNative();
    reader->AutoRescaleOn();
    reader->UpdateInformation();
    if (reader->GetErrorCode()) throw DamagedFileError(path, "a file of the series is damaged", kCopyAgain);
    const auto by_file = checked_slices(reader->GetMetaData(), names, path);
    reader->Update();
    if (reader->GetErrorCode()) throw DamagedFileError(path, "a file of the series is damaged or cut short", kCopyAgain);
    const std::vector<DicomSlice> slices = in_order(reader, by_file, path);

    Volume volume;
    std::array<int, 3> dimensions{};
    reader->GetOutput()->GetDimensions(dimensions.data());
    volume.size = {slices[0].columns, slices[0].rows, static_cast<int>(slices.size())};
    if (dimensions != volume.size) throw DamagedFileError(path, "its pictures could not be unpacked", kCopyAgain);
    volume.ct_from_voxel = ct_from_voxel_of(slices);
    check_against_reader(reader, volume.ct_from_voxel, volume.size, path);
    copy_values(reader->GetOutput(), volume, path);
    volume.modality = series.modality;
    volume.is_hu = values_are_hu(reader->GetMetaData(), volume);
    volume.frame_of_reference_uid = slices[0].frame_of_reference_uid;
    volume.source = fmt::format("DICOM series {}", series.uid);
    if (volume.ct_from_voxel.linear().determinant() < 0) reverse_k(volume);
    return volume;
}

}  // namespace planlight
