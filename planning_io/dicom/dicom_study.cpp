#include "planning_io/dicom/dicom_study.h"

#include <vtkDICOMDictionary.h>
#include <vtkDICOMMetaData.h>
#include <vtkDICOMParser.h>
#include <vtkNew.h>

#include <algorithm>
#include <array>
#include <utility>

#include "planning_io/dicom/choose_series.h"
#include "planning_io/files/check_exists.h"
#include "planning_io/files/sandboxed_process.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

std::string text(vtkDICOMMetaData* meta, vtkDICOMTag tag) {
    const vtkDICOMValue& value = meta->Get(tag);
    std::string result = value.IsValid() ? value.AsUTF8String() : std::string();
    while (!result.empty() && (result.back() == ' ' || result.back() == '\0')) result.pop_back();
    return result;
}

/// The texts of a study with the tags that they stand under.
std::array<std::pair<std::string DicomStudy::*, vtkDICOMTag>, 14> texts() {
    return {{{&DicomStudy::patient_name, DC::PatientName},
             {&DicomStudy::patient_id, DC::PatientID},
             {&DicomStudy::birth_date, DC::PatientBirthDate},
             {&DicomStudy::sex, DC::PatientSex},
             {&DicomStudy::study_uid, DC::StudyInstanceUID},
             {&DicomStudy::study_id, DC::StudyID},
             {&DicomStudy::study_date, DC::StudyDate},
             {&DicomStudy::study_time, DC::StudyTime},
             {&DicomStudy::study_description, DC::StudyDescription},
             {&DicomStudy::accession_number, DC::AccessionNumber},
             {&DicomStudy::referring_physician, DC::ReferringPhysicianName},
             {&DicomStudy::series_uid, DC::SeriesInstanceUID},
             {&DicomStudy::frame_of_reference_uid, DC::FrameOfReferenceUID},
             {&DicomStudy::image_class, DC::SOPClassUID}}};
}

void parse(Parcel& parcel, const fs::path& path, const std::string& wanted) {
    constexpr int kDepth = 10;
    const fs::path folder = fs::is_directory(path) ? path : path.parent_path();
    const DicomSeries series = choose_series(find_dicom(folder, fs::is_directory(path) ? kDepth : 1), path, wanted);
    if (!series.is_volume())
        throw InputError(path, "is no series of CT or MR images", "Name the series that the case was made from.");
    std::vector<std::string> uids;
    bool told = false;
    for (const DicomFile& file : series.files) {
        if (file.localizer) continue;  // none of the slices, and of another kind than they are
        vtkNew<vtkDICOMMetaData> meta;
        vtkNew<vtkDICOMParser> parser;
        parser->SetFileName(file.readable_as.c_str());
        parser->SetMetaData(meta);
        parser->Update();
        if (parser->GetErrorCode() != 0)
            throw DamagedFileError(file.path, "is damaged or cut short", "Copy the series again.");
        if (!std::exchange(told, true))
            for (const auto& [member, tag] : texts()) parcel.put(text(meta, tag));
        uids.push_back(text(meta, DC::SOPInstanceUID));
    }
    if (!told)
        throw InputError(path, "holds localizer pictures and no slice", "Name the series that the case was made from.");
    parcel.put(static_cast<std::uint64_t>(uids.size()));
    for (const std::string& uid : uids) parcel.put(uid);
}

}  // namespace

DicomStudy read_dicom_study(const fs::path& path, const std::string& series) {
    check_exists(path, "Name the folder of the planning series.");
    ChildLimits limits{"DICOM folder"};
    limits.processor_s = 120;
    Parcel parcel = parse_in_child(path, limits, [&](Parcel& to) { parse(to, path, series); });
    DicomStudy study;
    for (const auto& [member, tag] : texts()) study.*member = parcel.get_text();
    study.image_uids.resize(parcel.get<std::uint64_t>());
    for (std::string& uid : study.image_uids) uid = parcel.get_text();
    std::sort(study.image_uids.begin(), study.image_uids.end());
    study.image_uids.erase(std::unique(study.image_uids.begin(), study.image_uids.end()), study.image_uids.end());
    std::erase(study.image_uids, std::string());
    if (study.study_uid.empty())
        throw InputError(path, "does not say its study (Study Instance UID)",
                         "Export the series again from the scanner or the archive.");
    return study;
}

}  // namespace planlight
