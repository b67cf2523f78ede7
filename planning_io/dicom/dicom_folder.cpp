#include "planning_io/dicom/dicom_folder.h"

#include <fmt/format.h>
#include <vtkDICOMItem.h>
#include <vtkDICOMMetaData.h>
#include <vtkDICOMParser.h>
#include <vtkDICOMUtilities.h>
#include <vtkNew.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <map>
#include <set>
#include <utility>

#include "planning_io/dicom/fat_shift.h"
#include "planning_io/dicom/header_values.h"
#include "planning_io/dicom/inflated_dicom.h"
#include "planning_io/files/header_text.h"
#include "planning_io/files/sandboxed_process.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/volume_checks.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr int kMostFrames = 20000;
constexpr std::size_t kMostFiles = 200000;
const std::set<std::string> kVolumeClasses = {
    "1.2.840.10008.5.1.4.1.1.2",   "1.2.840.10008.5.1.4.1.1.2.1",
    "1.2.840.10008.5.1.4.1.1.2.2",  // CT, Enhanced CT, Legacy Converted Enhanced CT
    "1.2.840.10008.5.1.4.1.1.4",   "1.2.840.10008.5.1.4.1.1.4.1", "1.2.840.10008.5.1.4.1.1.4.4"};  // MR likewise

/// How the file says that what made the face recognisable was taken away (DICOM PS3.3 C.7.6.1.1.10, PS3.16 CID 7050).
std::string defaced(vtkDICOMMetaData* meta) {
    if (text_at(meta, vtkDICOMTag(0x0028, 0x0302)) == "NO") return "Recognizable Visual Features = NO";
    const vtkDICOMValue& codes = meta->Get(0, vtkDICOMTag(0x0012, 0x0064));
    const vtkDICOMItem* items = codes.GetSequenceData();
    for (std::size_t i = 0; items && i < codes.GetNumberOfValues(); ++i)
        if (plain(items[i].Get(DC::CodeValue).AsString()) == "113102")
            return "de-identification by code 113102, Clean Recognizable Visual Features";
    const std::string word =
        defacing_word_in(text_at(meta, vtkDICOMTag(0x0012, 0x0063)) + " " + text_at(meta, DC::SeriesDescription));
    return word.empty() ? "" : "\"" + word + "\" in its description";
}

/// MIP, MinIP or VRT as a word of a series' description; "thin, for MIP" is none.
std::string projection_word_in(const std::string& description) {
    std::string word, before;
    for (const char c : lower_case(description) + " ") {
        if (std::isalnum(static_cast<unsigned char>(c))) {
            word += c;
            continue;
        }
        const bool is_one = word == "mip" || word == "minip" || word == "vrt";
        if (is_one && before != "for" && before != "fuer" && before != "no")
            return word == "minip" ? "MinIP" : word == "mip" ? "MIP" : "VRT";
        if (!word.empty()) before = std::exchange(word, {});
    }
    return {};
}

/// How the file says that its picture was made of several slices (DICOM PS3.3 C.7.6.1.1.2 and C.8.16.1): maximum and
/// minimum intensity projections, subtractions.
std::string projected(vtkDICOMMetaData* meta) {
    const std::string type = "\\" + text_at(meta, DC::ImageType) + "\\";
    for (const char* word : {"MIP", "MINIP", "MAX_IP", "MIN_IP", "PROJECTION IMAGE", "SUBTRACTION", "SUBTRACT"})
        if (type.find(fmt::format("\\{}\\", word)) != std::string::npos) return std::string("Image Type ") + word;
    const std::string word = projection_word_in(text_at(meta, DC::SeriesDescription));
    return word.empty() ? "" : "\"" + word + "\" in its description";
}

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

/// "0.5 x 0.5 x 1.25 mm" of what is known, for people.
std::string spacing_text(const DicomSeries& series) {
    const auto slices = series.all_slices();
    if (slices.empty() || !std::isfinite(slices.front().column_spacing_mm)) return "-";
    std::string text = fmt::format("{:.3g} x {:.3g}", slices.front().column_spacing_mm, slices.front().row_spacing_mm);
    const Eigen::Vector3d normal = slices.front().row_direction.cross(slices.front().column_direction);
    if (std::any_of(slices.begin(), slices.end(), [](const auto& s) { return !s.position_in_ct.allFinite(); }) ||
        slices.size() < 2)
        return text + " mm";
    const auto [first, last] = std::minmax_element(slices.begin(), slices.end(), [&](const auto& a, const auto& b) {
        return normal.dot(a.position_in_ct) < normal.dot(b.position_in_ct);
    });
    return text + fmt::format(" x {:.3g} mm", (last->position_in_ct - first->position_in_ct).norm() /
                                                  static_cast<double>(slices.size() - 1));
}

std::string table_of(const std::vector<DicomSeries>& list) {
    std::string table = "\n  number  modality  slices  spacing  UID  \"description\"";
    for (const auto& s : list)
        table += fmt::format("\n  {}  {}  {}  {}  {}  \"{}\"{}", s.number.empty() ? "-" : s.number, s.modality,
                             s.slices(), spacing_text(s), s.uid, s.description,
                             s.slices() == 0                ? " (no pictures)"
                             : s.is_volume()                ? ""
                             : is_x_ray_3d(s.files.front()) ? " (" + words_of_class(s.files.front()) + ")"
                                                            : " (no CT or MR volume)");
    return table;
}

/// Whether a file that does not say of which series it is names this one, or its frame of reference, somewhere in its
/// first megabyte: then it is a damaged slice of it.
bool names_series(const fs::path& file, const DicomSeries& series) {
    std::string bytes(std::size_t{1} << 20, '\0');
    std::ifstream in(file, std::ios::binary);
    in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(in.gcount()));
    std::vector<std::string> uids{series.uid};
    for (const auto& slice : series.all_slices())
        if (!slice.frame_of_reference_uid.empty()) uids.push_back(slice.frame_of_reference_uid);
    std::sort(uids.begin(), uids.end());
    uids.erase(std::unique(uids.begin(), uids.end()), uids.end());
    return std::any_of(uids.begin(), uids.end(),
                       [&](const std::string& uid) { return bytes.find(uid) != std::string::npos; });
}

bool holds(const DicomSeries& series, const fs::path& path) {
    std::error_code error;
    return std::any_of(series.files.begin(), series.files.end(),
                       [&](const DicomFile& f) { return fs::equivalent(f.path, path, error); });
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
                       [](const DicomFile& f) { return kVolumeClasses.contains(f.storage_class); }) &&
           std::any_of(files.begin(), files.end(),
                       [](const DicomFile& f) { return !f.localizer && !f.slices.empty(); });
}

std::string words_of_class(const DicomFile& file) {
    static const std::map<std::string, std::string> kWords = {
        {"1.1", "a computed radiograph"},
        {"3.1", "an ultrasound sequence"},
        {"6.1", "an ultrasound picture"},
        {"7", "a secondary capture"},
        {"7.4", "a secondary capture"},
        {"9.1.1", "an electrocardiogram"},
        {"13.1.1", "an X-ray 3D angiographic image"},
        {"13.1.2", "a cone beam CT stored as an X-ray 3D craniofacial image"},
        {"13.1.3", "an X-ray 3D breast image"},
        {"20", "a nuclear medicine image"},
        {"66.4", "a segmentation"},
        {"88.11", "a report"},
        {"88.22", "a report"},
        {"88.33", "a report"},
        {"88.59", "a list of key pictures"},
        {"104.1", "a PDF"},
        {"128", "a PET image"},
        {"481.2", "a radiotherapy dose"},
        {"481.3", "a plan (RTSTRUCT)"},
        {"481.5", "a radiotherapy plan"}};
    const std::string before = "1.2.840.10008.5.1.4.1.1.";
    if (file.storage_class.starts_with(before))
        if (const auto words = kWords.find(file.storage_class.substr(before.size())); words != kWords.end())
            return words->second;
    return fmt::format("of modality \"{}\", storage class {}", file.modality, file.storage_class);
}

bool is_x_ray_3d(const DicomFile& file) {
    return file.storage_class.starts_with("1.2.840.10008.5.1.4.1.1.13.1.");
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

DicomSeries choose_series(const DicomFolder& folder, const fs::path& path, const std::string& wanted) {
    std::vector<DicomSeries> chosen;
    const bool is_folder = fs::is_directory(path);
    const bool says_folder = is_folder || is_dicom_directory(path);
    for (const DicomSeries& s : folder.series)
        if (!wanted.empty() ? s.uid == wanted || s.number == wanted : says_folder ? s.is_volume() : holds(s, path))
            chosen.push_back(s);
    if (chosen.size() > 1 && wanted.empty() &&
        std::any_of(chosen.begin(), chosen.end(), [](const auto& s) { return s.slices() >= kFewestSlices; }))
        std::erase_if(chosen,
                      [](const DicomSeries& s) { return s.slices() < kFewestSlices; });  // a few slices are no rival
    for (const auto& file : folder.unreadable)  // of others, a damaged file does not matter
        if (fs::equivalent(file, path) || (says_folder && chosen.empty()) ||
            std::any_of(chosen.begin(), chosen.end(), [&](const auto& s) { return names_series(file, s); }))
            throw DamagedFileError(
                file, "is a DICOM file that is damaged or does not say of which series it is",
                "Copy or export the series again; if the file is not of the series, move it elsewhere.");
    if (!says_folder && wanted.empty() && chosen.empty())
        throw InputError(
            path, "is no DICOM file, nor any other kind of volume that is read",
            "Name a folder with a CT or MR series, or a file: .nii, .nii.gz, .nrrd, .nhdr, .mha, .mhd, .inv3.");
    if (folder.series.empty())
        throw InputError(
            path, "holds no DICOM images",
            "Name a folder with a CT or MR series, or a file: .nii, .nii.gz, .nrrd, .nhdr, .mha, .mhd, .inv3.");
    if (chosen.empty())
        throw InputError(
            path,
            (wanted.empty() ? "holds no CT or MR volume; there is:"
                            : "holds no series of the UID or number " + wanted + "; there is:") +
                table_of(folder.series),
            std::ranges::any_of(folder.series, [](const DicomSeries& s) { return is_x_ray_3d(s.files.front()); })
                ? "Export it from the scanner's program as CT Image Storage."
                : "Name a folder with a CT or MR series of slices.");
    if (chosen.size() > 1 && wanted.empty() && chosen.front().slices() < kFewestSlices)
        throw InputError(path,
                         fmt::format("holds no CT or MR volume of {} slices or more; there is:", kFewestSlices) +
                             table_of(folder.series),
                         "Name a folder with a CT or MR series of thin slices.");
    if (chosen.size() > 1)
        throw InputError(path, "holds several series:" + table_of(wanted.empty() ? folder.series : chosen),
                         "Choose one by its UID (--series UID).");
    return chosen.front();
}

}  // namespace planlight
