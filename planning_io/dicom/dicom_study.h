#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace planlight {

/// What the objects that are added to a study must say as its images say it. Texts are UTF-8; empty where not said.
struct DicomStudy {
    std::string patient_name, patient_id, birth_date, sex;
    std::string study_uid, study_id, study_date, study_time, study_description, accession_number, referring_physician;
    std::string series_uid, frame_of_reference_uid;  ///< of the planning series
    std::string image_class;                         ///< SOP class of its images
    std::vector<std::string> image_uids;             ///< SOP instances of its images, each once
};

/// The study of a series of CT or MR images, as `read_volume` chooses it, read in a child process. Throws InputError
/// where the path holds no such series, or one that does not say its study; DamagedFileError.
DicomStudy read_dicom_study(const std::filesystem::path& folder_or_file, const std::string& series = {});

}  // namespace planlight
