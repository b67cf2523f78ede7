#include "planning_io/dicom/dicom_series.h"

#include <fmt/format.h>
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
#include <numbers>
#include <vector>

#include "planning_io/dicom/choose_series.h"
#include "planning_io/dicom/dicom_values.h"
#include "planning_io/dicom/storage_class.h"
#include "planning_io/files/header_text.h"
#include "planning_io/files/memory_need.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/slice_faults.h"
#include "planning_io/volume/volume_checks.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr int kScanDepth = 10;
constexpr const char* kTooLarge = "Close other programs, or give a series of fewer or smaller slices.";
constexpr double kTilted = 1e-3;  // radians
constexpr double kEven_mm = 0.01;
constexpr const char* kCopyAgain = "Copy or export the series again.";

/// File and frame of each slice of the reader's volume.
using SliceOrder = std::vector<std::pair<std::size_t, std::size_t>>;

SliceOrder order_of(vtkDICOMReader* reader, const DicomSeries& series, const fs::path& path) {
    vtkIntArray *files = reader->GetFileIndexArray(), *frames = reader->GetFrameIndexArray();
    SliceOrder order;
    for (vtkIdType s = 0; files && s < files->GetNumberOfTuples(); ++s)
        order.emplace_back(
            static_cast<std::size_t>(files->GetComponent(s, 0)),
            frames && frames->GetNumberOfTuples() > s ? static_cast<std::size_t>(frames->GetComponent(s, 0)) : 0);
    if (static_cast<int>(order.size()) != series.slices() || (files && files->GetNumberOfComponents() != 1))
        throw InputError(
            path, fmt::format("its {} pictures do not stack to one volume ({} slices)", series.slices(), order.size()),
            "Export one series of one time point.");
    return order;
}

/// The file that cannot be unpacked by itself; `path` when each can.
fs::path damaged_file_of(const DicomSeries& series, const fs::path& path) {
    for (const auto& file : series.files) {
        vtkNew<vtkDICOMReader> reader;
        reader->SetFileName(file.readable_as.c_str());
        reader->Update();
        if (reader->GetErrorCode()) return file.path;
    }
    return path;
}

/// The affine from the slices' own positions must agree with vtk-dicom's reading of them: two readings, one geometry.
void check_against_reader(vtkDICOMReader* reader, const Volume& volume, double axes_off, const fs::path& path) {
    double within_mm = 0.1;
    for (std::size_t axis = 0; axis < 2; ++axis)  // the reader leaves coarsely written directions as they are
        within_mm += axes_off * volume.size[axis] * volume.spacing_mm()[static_cast<Eigen::Index>(axis)];
    const double* spacing = reader->GetOutput()->GetSpacing();
    for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector3d voxel((corner & 1) * (volume.size[0] - 1), ((corner >> 1) & 1) * (volume.size[1] - 1),
                                    (corner >> 2) * (volume.size[2] - 1));
        const std::array<double, 4> in{voxel.x() * spacing[0], voxel.y() * spacing[1], voxel.z() * spacing[2], 1};
        std::array<double, 4> out{};
        reader->GetPatientMatrix()->MultiplyPoint(in.data(), out.data());
        if (!((volume.ct_from_voxel * voxel - Eigen::Vector3d(out[0], out[1], out[2])).norm() < within_mm))
            throw DamagedFileError(
                path, fmt::format("two readings of its geometry disagree by more than {:.1f} mm", within_mm),
                kCopyAgain);
    }
}

template <class T>
void copy_as(vtkDataArray* scalars, Volume& volume) {
    const T* stored = static_cast<const T*>(scalars->GetVoidPointer(0));
    std::transform(stored, stored + volume.values.size(), volume.values.begin(),
                   [](T v) { return static_cast<float>(v); });
}

void copy_stored_values(vtkImageData* image, Volume& volume, const fs::path& path) {
    vtkDataArray* scalars = image->GetPointData()->GetScalars();
    const auto count = volume.index(0, 0, volume.size[2]);
    std::array<int, 3> dimensions{};
    image->GetDimensions(dimensions.data());
    if (dimensions != volume.size || !scalars || scalars->GetNumberOfComponents() != 1 ||
        static_cast<std::size_t>(scalars->GetNumberOfTuples()) != count)
        throw DamagedFileError(path, "its pictures could not be unpacked", kCopyAgain);
    volume.values.resize(count);
    switch (scalars->GetDataType()) {
        case VTK_UNSIGNED_SHORT:
            return copy_as<unsigned short>(scalars, volume);
        case VTK_SHORT:
            return copy_as<short>(scalars, volume);
        case VTK_UNSIGNED_CHAR:
            return copy_as<unsigned char>(scalars, volume);
        default:
            break;
    }
    for (std::size_t i = 0; i < count; ++i)
        volume.values[i] = static_cast<float>(scalars->GetComponent(static_cast<vtkIdType>(i), 0));
}

/// Slices that stand straight where the gantry was tilted: on some way through other systems the tilt is lost, and
/// the head is sheared; where they were computed anew the mark alone is old.
void note_lost_tilt(const std::vector<DicomSlice>& slices, Volume& volume) {
    constexpr double kLeast_deg = 1, kApart_deg = 1;
    if (slices.empty()) return;
    const double said_deg = std::abs(slices[slices.size() / 2].gantry_tilt_deg),
                 found_deg = tilt_of(volume.ct_from_voxel) * 180 / std::numbers::pi;
    if (!(said_deg > kLeast_deg) || std::abs(said_deg - found_deg) <= kApart_deg) return;
    volume.notes.push_back(fmt::format(
        "the header says that the gantry was tilted by {:.1f} degrees, and the slices stand tilted by {:.1f}: if the "
        "tilt was lost on the way, the head is sheared and everything on it in the wrong place; compare the head's "
        "profile in the views, and give the series as the scanner made it",
        said_deg, found_deg));
}

void note_geometry(const DicomSeries& series, Volume& volume) {
    if (const double tilt = tilt_of(volume.ct_from_voxel); tilt > kTilted)
        volume.notes.push_back(
            fmt::format("the gantry was tilted by {:.1f} degrees: the slices stay where they were, sheared",
                        tilt * 180 / std::numbers::pi));
    const auto slices = series.all_slices();
    if (const double off = axes_off(slices.front()); off > kAsWritten)
        volume.notes.push_back(
            fmt::format("the directions of its rows and columns are written in few digits (off by {:.1g}): they were "
                        "made of length "
                        "1 and perpendicular",
                        off));
    note_lost_tilt(slices, volume);
    if (std::any_of(series.files.begin(), series.files.end(), [](const DicomFile& f) { return f.was_lossy; }) ||
        std::any_of(slices.begin(), slices.end(),
                    [](const DicomSlice& s) { return transfer_syntax_of(s.transfer_syntax) == TransferSyntax::lossy; }))
        volume.notes.push_back("the pictures were compressed with loss");
}

/// Slices that overlap by more than half are means over what lies around them: their skin is blurred along the stack.
void note_thickness(const std::vector<DicomSlice>& slices, Volume& volume) {
    constexpr double kMostSteps = 2.2, kThin_mm = 3;
    const double step = volume.ct_from_voxel.linear().col(2).norm(), thick = slices[slices.size() / 2].thickness_mm;
    if (thick > kThin_mm && thick > kMostSteps * step)
        volume.notes.push_back(fmt::format(
            "each of its slices is {:.1f} mm thick, and they stand {:.1f} mm apart: the skin is blurred, and "
            "may be swollen where it is round; give thinner slices if there are any",
            thick, step));
}

/// Slices that lie off their places on an even grid: laid onto one of the smallest step, linear between the cuts where
/// they really are. Those that are even enough without that are left as they are, and it is said.
void lay_on_even_grid(Volume& volume, const std::vector<DicomSlice>& slices) {
    const double off_mm = unevenness_of(slices);
    if (off_mm < kEven_mm) return;
    const std::vector<double> places = places_along_stack(slices);
    std::vector<double> steps;
    for (std::size_t i = 1; i < places.size(); ++i) steps.push_back(std::abs(places[i] - places[i - 1]));
    const auto [least, most] = std::minmax_element(steps.begin(), steps.end());
    if (is_even(slices)) {
        volume.notes.push_back(fmt::format("its slices lie up to {:.2f} mm off an even spacing of {:.2f} mm", off_mm,
                                           std::abs(places.back()) / static_cast<double>(steps.size())));
        return;
    }
    const double length = std::abs(places.back()), sign = places.back() < 0 ? -1 : 1;
    const int count = static_cast<int>(std::ceil(length / *least - 1e-6)) + 1;
    const double step = length / (count - 1);
    const std::size_t slab = volume.index(0, 0, 1);
    std::vector<float> laid(slab * static_cast<std::size_t>(count));
    std::size_t below = 0;
    for (int k = 0; k < count; ++k) {
        const double at = step * k;
        while (below + 2 < places.size() && sign * places[below + 1] <= at) ++below;
        const auto f = static_cast<float>(
            std::clamp((at - sign * places[below]) / (sign * (places[below + 1] - places[below])), 0.0, 1.0));
        const float *low = volume.values.data() + below * slab, *high = low + slab;
        float* to = laid.data() + static_cast<std::size_t>(k) * slab;
        for (std::size_t v = 0; v < slab; ++v) to[v] = low[v] + f * (high[v] - low[v]);
    }
    volume.values = std::move(laid);
    volume.ct_from_voxel.linear().col(2) = volume.ct_from_voxel.linear().col(2).normalized() * step;
    volume.size[2] = count;
    volume.widest_gap_mm = *most;
    volume.notes.push_back(
        fmt::format("its {} slices lie {:.2f} to {:.2f} mm apart; they were laid onto an even grid of {} with steps of "
                    "{:.2f} mm, linear between the cuts: where they are far apart the skin is coarser",
                    slices.size(), *least, *most, count, step));
}

/// "CT" or "MR" as the pictures are stored; what they say besides must be the same.
std::string modality_of(const DicomSeries& series) {
    const auto stored_as = [](const DicomFile& file) {
        return file.storage_class.starts_with("1.2.840.10008.5.1.4.1.1.4") ? "MR" : "CT";
    };
    const std::string modality = stored_as(series.files.front());
    for (const DicomFile& file : series.files)
        if (stored_as(file) != modality || (!file.modality.empty() && file.modality != modality))
            throw InputError(file.path,
                             fmt::format("is stored as {} and says that it is of modality \"{}\", in a series of {}",
                                         stored_as(file), file.modality, modality),
                             kCopyAgain);
    return modality;
}

/// The reader's own pictures, mostly of 16 bits, and ours beside them.
std::uint64_t memory_to_read(const DicomSeries& series) {
    std::uint64_t pixels = 0;
    for (const auto& file : series.files)
        for (const auto& slice : file.slices)
            pixels += static_cast<std::uint64_t>(std::max(slice.rows, 0)) *
                      static_cast<std::uint64_t>(std::max(slice.columns, 0));
    return pixels * (sizeof(std::uint16_t) + sizeof(float));
}

/// A localizer that a scanner put into the series of the slices is not one of them.
int leave_localizers_aside(DicomSeries& series) {
    const auto before = series.files.size();
    if (std::any_of(series.files.begin(), series.files.end(), [](const DicomFile& f) { return !f.localizer; }))
        std::erase_if(series.files, [](const DicomFile& f) { return f.localizer; });
    return static_cast<int>(before - series.files.size());
}

/// The folder that a series lies in, and how deep; of a file its own folder only.
std::pair<fs::path, int> place_to_search(const fs::path& path) {
    const bool is_folder = fs::is_directory(path);
    const fs::path folder = is_folder ? path : path.has_parent_path() ? path.parent_path() : fs::path(".");
    return {folder, is_folder || is_dicom_directory(path) ? kScanDepth : 1};
}

}  // namespace

std::vector<fs::path> crashing_files_of(const fs::path& path) {
    const auto [folder, depth] = place_to_search(path);
    return headers_that_crash(folder, depth);
}

Volume parse_dicom_series(const fs::path& path, const std::string& wanted, SliceGaps gaps,
                          const std::vector<fs::path>& unreadable, SeriesIdentity* identity) {
    const auto [folder, depth] = place_to_search(path);
    const DicomFolder found = find_dicom(folder, depth, unreadable);
    DicomSeries series = choose_series(found, path, wanted);
    const int localizers = leave_localizers_aside(series);
    for (const auto& file : series.files)
        if (file.damaged) throw DamagedFileError(file.path, "is damaged or cut short in its header", kCopyAgain);
    if (!series.is_volume())
        throw InputError(
            path,
            "is no CT or MR volume but " +
                words_of_class(series.files.front().storage_class, series.files.front().modality),
            is_x_ray_3d(series.files.front().storage_class) ? kExportAsCt : "Give a series of CT or MR image objects.");
    const std::string modality = modality_of(series);
    for (const auto& file : series.files)
        if (file.has_value_table)
            throw InputError(file.path, "says its values by a table (Modality LUT), which is not read",
                             "Export the series with rescale slope and intercept.");
    if (const auto fault = fault_of(series.all_slices(), gaps)) {
        if (!found.unreadable.empty())  // perhaps what is missing
            throw DamagedFileError(found.unreadable.front(),
                                   "is a DICOM file that is damaged, and without it the series " + fault->problem,
                                   kCopyAgain);
        throw InputError(path, fault->problem, fault->remedy);
    }
    check_memory(path.string() + ": reading its pictures", memory_to_read(series), kTooLarge);

    vtkNew<vtkStringArray> names;
    for (const auto& file : series.files) names->InsertNextValue(file.readable_as);
    vtkNew<vtkDICOMReader> reader;
    reader->SetFileNames(names);
    reader->SetMemoryRowOrderToFileNative();
    reader->AutoRescaleOff();
    reader->UpdateInformation();
    if (!reader->GetErrorCode()) reader->Update();
    if (reader->GetErrorCode())
        throw DamagedFileError(damaged_file_of(series, path), "is damaged or cut short", kCopyAgain);

    std::vector<DicomSlice> slices;
    std::vector<SliceValues> meaning;
    for (const auto& [file, frame] : order_of(reader, series, path)) {
        const DicomFile& of = series.files.at(file);
        slices.push_back(of.slices.at(frame));
        meaning.push_back({slices.back().slope, slices.back().intercept, of.has_padding, of.padding, of.padding_limit});
    }
    const DicomFile& first = series.files.front();
    if (identity) *identity = {first.patient_hash, first.study_uid, series.uid};
    Volume volume;
    volume.size = {slices[0].columns, slices[0].rows, static_cast<int>(slices.size())};
    volume.ct_from_voxel = ct_from_voxel_of(slices);
    volume.modality = modality;
    volume.frame_of_reference_uid = slices[0].frame_of_reference_uid;
    volume.source = fmt::format("DICOM series {}", series.uid);
    volume.series_description = series.description;
    volume.series_date = series.files.front().date;
    volume.fat_shift_in_ct = slices[slices.size() / 2].fat_shift_in_ct;
    if (!found.unreadable.empty())
        volume.notes.push_back(fmt::format(
            "left aside: {} that {} damaged and {} not say of which series: if a slice at the end of this one is among "
            "them, the volume ends before it",
            counted(static_cast<long long>(found.unreadable.size()), "DICOM file"),
            found.unreadable.size() == 1 ? "is" : "are", found.unreadable.size() == 1 ? "does" : "do"));
    if (localizers > 0)
        volume.notes.push_back("left aside: " + counted(localizers, "localizer picture") + " of the series");
    note_geometry(series, volume);
    check_against_reader(reader, volume, axes_off(slices.front()), path);
    copy_stored_values(reader->GetOutput(), volume, path);
    rescale(volume, meaning, series.files.front().rescale_type, slices.front().has_rescale);
    lay_on_even_grid(volume, slices);
    note_thickness(slices, volume);
    make_right_handed(volume);
    check_for_skin(volume, path);
    note_slice_faults(volume, 2);  // within a slice none can be missing
    return volume;
}

}  // namespace planlight
