#pragma once

#include <string>

namespace planlight {

/// Whose a DICOM series is, to be compared while it is read and kept nowhere; each is empty when not said.
struct SeriesIdentity {
    std::string patient_hash;  ///< of the Patient ID
    std::string study_uid, series_uid;
};

}  // namespace planlight
