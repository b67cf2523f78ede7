#pragma once

#include <filesystem>
#include <string>

#include "planning_io/dicom/dicom_study.h"
#include "planning_io/types/image.h"
#include "planning_io/types/rigid_transform.h"

namespace planlight {

/// What each object that is added to a study says of itself. The same content, title and program have the same UID, so
/// that what is written twice is one object; with any other byte of picture, document or match it is another.
struct DicomObjectName {
    std::string made;         ///< ISO 8601, UTC; written in local time without a zone, as the study's own times are
    std::string program;      ///< version
    std::string series;       ///< what the series is told by from others of this program: the objects of one are one
    std::string description;  ///< of the series, for people
    int series_number = 1, number = 1;
    std::string id;  ///< what the object is made of, besides its content: hashes
};

/// A match as a Spatial Registration object (PS3.3 A.39.1): the registered frame of reference is that of the planning
/// series, to which the frame of the rig at the scan, `frame_uid_of_rig`, is joined by `ct_from_rig` (mm, LPS).
void write_spatial_registration(const DicomStudy& study, const DicomObjectName& name, const RigidTransform& ct_from_rig,
                                const std::string& frame_uid_of_rig, const std::filesystem::path& file);

/// A document (bytes of a PDF) as an Encapsulated PDF object (PS3.3 A.45.1).
void write_encapsulated_pdf(const DicomStudy& study, const DicomObjectName& name, const std::string& title,
                            const std::string& pdf, const std::filesystem::path& file);

/// What of a patient may be read off a picture: Recognizable Visual Features, and Burned In Annotation.
struct PictureShows {
    bool face = true, words = true;
};

/// A picture as a Secondary Capture object (PS3.3 A.8.1), RGB.
void write_secondary_capture(const DicomStudy& study, const DicomObjectName& name, const std::string& comment,
                             const RgbImage& picture, const PictureShows& shows, const std::filesystem::path& file);

/// A UID that is the same whenever it is made of the same text.
std::string dicom_uid_of(const std::string& content);

}  // namespace planlight
