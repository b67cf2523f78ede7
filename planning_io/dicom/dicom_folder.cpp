#include "planning_io/dicom/dicom_folder.h"

#include <fmt/format.h>
#include <vtkDICOMItem.h>
#include <vtkDICOMMetaData.h>
#include <vtkDICOMParser.h>
#include <vtkDICOMUtilities.h>
#include <vtkNew.h>

#include <algorithm>
#include <array>
#include <fstream>

#include "planning_io/dicom/altered_pictures.h"
#include "planning_io/dicom/fat_shift.h"
#include "planning_io/dicom/header_values.h"
#include "planning_io/dicom/inflated_dicom.h"
#include "planning_io/dicom/storage_class.h"
#include "planning_io/files/header_text.h"
#include "planning_io/files/sandboxed_process.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/volume_checks.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr int kMostFrames = 20000;
constexpr std::size_t kMostFiles = 200000;
DicomSlice slice_of(vtkDICOMMetaData* meta, int frame, const std::string& name) {
    DicomSlice slice;
    slice.file = name;
    const auto p = numbers_at(meta, frame, DC::ImagePositionPatient, 3);
    const auto o = numbers_at(meta, frame, DC::ImageOrientationPatient, 6);
    const auto spacing = numbers_at(meta, frame, DC::PixelSpacing, 2);
    slice.position_in_ct = {p[0], p[1], p[2]};
    slice.row_direction = {o[0], o[1], o[2]};
    slice.column_direction = {o[3], o[4], o[5]};
    slice.row_spacing_mm = spacing[0];
    slice.column_spacing_mm = spacing[1];
    if (meta->Get(0, frame, DC::RescaleSlope).IsValid() || meta->Get(0, frame, DC::RescaleIntercept).IsValid()) {
        slice.has_rescale = true;
        slice.slope = numbers_at(meta, frame, DC::RescaleSlope, 1)[0];
        slice.intercept = numbers_at(meta, frame, DC::RescaleIntercept, 1)[0];
    }
    slice.thickness_mm = numbers_at(meta, frame, DC::SliceThickness, 1)[0];
    slice.gantry_tilt_deg = numbers_at(meta, frame, DC::GantryDetectorTilt, 1)[0];
    slice.fat_shift_in_ct = fat_shift_of(meta, frame, slice);
    return slice;
}

/// What all frames of a file have in common.
void add_common(vtkDICOMMetaData* meta, DicomFile& file) {
    const std::string patient =
        plain(meta->Get(0, DC::PatientID).AsString()) + "\\" + plain(meta->Get(0, DC::PatientName).AsString());
    const std::string frame_of_reference = text_at(meta, DC::FrameOfReferenceUID),
                      position = text_at(meta, DC::PatientPosition);
    const std::string stored =
        fmt::format("{} of {} bits, {}", meta->Get(0, DC::BitsStored).AsInt(), meta->Get(0, DC::BitsAllocated).AsInt(),
                    meta->Get(0, DC::PixelRepresentation).AsInt() ? "signed" : "unsigned");
    const std::string made_of_several = projected(meta), face = defaced(meta),
                      syntax = text_at(meta, DC::TransferSyntaxUID);
    for (DicomSlice& slice : file.slices) {
        slice.patient = patient;
        slice.frame_of_reference_uid = frame_of_reference;
        slice.patient_position = position;
        slice.stored_as = stored;
        slice.transfer_syntax = syntax;
        slice.defaced = face;
        slice.projected = made_of_several;
        slice.rows = meta->Get(0, DC::Rows).AsInt();
        slice.columns = meta->Get(0, DC::Columns).AsInt();
        slice.samples = meta->Get(0, DC::SamplesPerPixel).AsInt();
    }
}

/// "20010514" as "2001-05-14"; empty where it is no date.
std::string iso_date(const std::string& text) {
    if (text.size() != 8 || text.find_first_not_of("0123456789") != std::string::npos) return "";
    return text.substr(0, 4) + "-" + text.substr(4, 2) + "-" + text.substr(6, 2);
}

/// False when the header does not even say of which series the file is.
bool read_header(DicomFile& file, bool& is_directory) {
    file.readable_as = inflated_dicom(file.path);
    vtkNew<vtkDICOMMetaData> meta;
    vtkNew<vtkDICOMParser> parser;
    parser->SetMetaData(meta);
    parser->SetFileName(file.readable_as.c_str());
    parser->Update();
    file.storage_class = text_at(meta, DC::SOPClassUID);
    is_directory = file.storage_class == "1.2.840.10008.1.3.10" ||
                   text_at(meta, vtkDICOMTag(0x0002, 0x0002)) == "1.2.840.10008.1.3.10";
    if (is_directory) return true;
    file.series_uid = text_at(meta, DC::SeriesInstanceUID);
    file.study_uid = text_at(meta, DC::StudyInstanceUID);
    file.patient_hash = patient_hash(meta);
    file.modality = text_at(meta, DC::Modality);
    file.description = text_at(meta, DC::SeriesDescription);
    file.number = text_at(meta, DC::SeriesNumber);
    file.rescale_type = text_at(meta, DC::RescaleType);
    file.date = iso_date(text_at(meta, DC::SeriesDate));
    if (file.date.empty()) file.date = iso_date(text_at(meta, DC::StudyDate));
    file.localizer = text_at(meta, DC::ImageType).find("LOCALIZER") != std::string::npos;
    file.was_lossy = text_at(meta, DC::LossyImageCompression) == "01";
    file.has_value_table = meta->Get(0, DC::ModalityLUTSequence).IsValid();
    const vtkDICOMValue &padding = meta->Get(0, DC::PixelPaddingValue),
                        &limit = meta->Get(0, DC::PixelPaddingRangeLimit);
    file.has_padding = padding.IsValid();
    if (file.has_padding) {
        const int a = padding.AsInt(), b = limit.IsValid() ? limit.AsInt() : a;
        file.padding = std::min(a, b), file.padding_limit = std::max(a, b);
    }
    file.damaged = parser->GetErrorCode() != 0;
    if (file.series_uid.empty()) return false;
    if (parser->GetPixelDataFound() || file.damaged) {
        const int frames = std::clamp(meta->Get(0, DC::NumberOfFrames).AsInt(), 1, kMostFrames);
        const std::string name = file.path.filename().string();
        for (int frame = 0; frame < frames; ++frame)
            file.slices.push_back(
                slice_of(meta, frame, frames > 1 ? fmt::format("{} frame {}", name, frame + 1) : name));
        add_common(meta, file);
    }
    return true;
}

/// The same of a file that may be damaged in any way: what cannot be read at all is somebody's, but not known whose.
bool read_any_header(DicomFile& file, bool& is_directory) {
    try {
        return read_header(file, is_directory);
    } catch (const DamagedFileError&) {
        return false;
    } catch (const std::bad_alloc&) {  // a length that is a lie
        return false;
    }
}

std::vector<fs::path> files_in(const fs::path& folder, int depth) {
    std::vector<fs::path> files;
    std::error_code error;
    for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
        if (entry.depth() >= depth - 1) entry.disable_recursion_pending();
        std::error_code ignored;
        if (entry->is_regular_file(ignored))
            files.push_back(entry->path());
        else if (entry->is_symlink(ignored) && !entry->exists(ignored))
            throw InputError(entry->path(), "is a link to a file that is not there, and may be a slice",
                             "Copy the whole series again.");
        if (files.size() > kMostFiles)
            throw InputError(folder, fmt::format("holds more than {} files", kMostFiles),
                             "Name the folder of the study.");
    }
    if (error)  // slices may be there
        throw InputError(folder, "cannot be searched to its end: " + error.message(),
                         "Check the permissions of the folders in it.");
    std::sort(files.begin(), files.end());
    return files;
}

/// Whether it has DICOM's mark; without it a file may merely look like a data set. A file that cannot be opened may be
/// a slice: InputError.
bool says_dicom(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in)
        throw InputError(file, "cannot be opened, and may be a slice",
                         "Check the permissions of the file, or move it elsewhere.");
    std::string mark(4, '\0');
    return in.seekg(128) && in.read(mark.data(), 4) && mark == "DICM";
}

}  // namespace

int DicomSeries::slices() const {
    int count = 0;
    for (const auto& file : files) count += static_cast<int>(file.slices.size());
    return count;
}

std::vector<DicomSlice> DicomSeries::all_slices() const {
    std::vector<DicomSlice> all;
    for (const auto& file : files) all.insert(all.end(), file.slices.begin(), file.slices.end());
    return all;
}

bool DicomSeries::is_volume() const {
    return std::all_of(files.begin(), files.end(),
                       [](const DicomFile& f) { return is_volume_class(f.storage_class); }) &&
           std::any_of(files.begin(), files.end(),
                       [](const DicomFile& f) { return !f.localizer && !f.slices.empty(); });
}

bool is_dicom_directory(const fs::path& file) {
    return lower_case(file.filename().string()).starts_with("dicomdir");
}

std::vector<fs::path> headers_that_crash(const fs::path& folder, int depth) {
    std::vector<fs::path> crashing;
    for (const fs::path& path : files_in(folder, depth)) {
        if (!says_dicom(path)) continue;
        try {
            parse_in_child(path, {"DICOM header"}, [&](Parcel&) {
                DicomFile file;
                file.path = path;
                bool is_directory = false;
                read_any_header(file, is_directory);
            });
        } catch (const ParserCrash&) {
            crashing.push_back(path);
        }
    }
    return crashing;
}

DicomFolder find_dicom(const fs::path& folder, int depth, const std::vector<fs::path>& unreadable) {
    DicomFolder found;
    found.unreadable = unreadable;
    for (const fs::path& path : files_in(folder, depth)) {
        if (std::find(unreadable.begin(), unreadable.end(), path) != unreadable.end()) continue;
        if (!says_dicom(path) && !vtkDICOMUtilities::IsDICOMFile(path.c_str())) continue;
        DicomFile file;
        file.path = path;
        bool is_directory = false;
        if (!read_any_header(file, is_directory)) {
            if (says_dicom(path)) found.unreadable.push_back(path);
        } else if (!is_directory) {
            auto series = std::find_if(found.series.begin(), found.series.end(),
                                       [&](const DicomSeries& s) { return s.uid == file.series_uid; });
            if (series == found.series.end())
                series = found.series.insert(
                    found.series.end(), DicomSeries{file.series_uid, file.modality, file.description, file.number, {}});
            series->files.push_back(std::move(file));
        }
    }
    return found;
}

}  // namespace planlight
