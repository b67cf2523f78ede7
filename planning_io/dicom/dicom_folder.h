#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planning_io/dicom/dicom_slices.h"

namespace planlight {

/// One DICOM object as it lies in a folder.
struct DicomFile {
    std::filesystem::path path;
    std::string readable_as;  ///< where to read it from: `path`, or its inflated copy in memory
    std::string series_uid, modality, description, number, storage_class, rescale_type;
    std::string study_uid, patient_hash;  ///< empty when not said
    std::string date;                     ///< of the series, else of the study: ISO 8601; empty when not said
    bool localizer = false;
    bool damaged = false;          ///< the header ends too early or makes no sense
    bool was_lossy = false;        ///< its pictures lost something once, however they are stored now
    bool has_value_table = false;  ///< a Modality LUT in place of slope and intercept
    bool has_padding = false;
    int padding = 0, padding_limit = 0;  ///< stored values that stand for "nothing was measured", from - to
    std::vector<DicomSlice> slices;      ///< one, or one a frame; empty for an object without pixels
};

/// The files of one series, in the order of their names.
struct DicomSeries {
    std::string uid, modality, description, number;
    std::vector<DicomFile> files;
    int slices() const;
    std::vector<DicomSlice> all_slices() const;
    /// CT or MR image objects (Enhanced ones too), and not localizers only.
    bool is_volume() const;
};

/// What a folder of DICOM files holds: its series, and what could not be used.
struct DicomFolder {
    std::vector<DicomSeries> series;
    std::vector<std::filesystem::path> unreadable;  ///< DICOM files that do not say of which series they are
};

/// Finds every DICOM object in a folder (ten levels deep, whatever the files are called; DICOMDIR is not needed and not
/// believed). Throws InputError for more than 200,000 files, and for what cannot be opened: it may be a slice. Crashes
/// on some damaged files: to be called in a child process.
///
/// Files of `unreadable` (those of `headers_that_crash`) are not looked into.
DicomFolder find_dicom(const std::filesystem::path& folder, int depth,
                       const std::vector<std::filesystem::path>& unreadable = {});

/// The DICOM files below a folder whose header brings the parser down, each tried in a child process of its own: for
/// when the whole folder did.
std::vector<std::filesystem::path> headers_that_crash(const std::filesystem::path& folder, int depth);

/// Whether a file is a DICOMDIR by its name: it stands for its folder.
bool is_dicom_directory(const std::filesystem::path& file);

}  // namespace planlight
