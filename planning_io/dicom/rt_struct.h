#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planning_io/types/series_identity.h"

namespace planlight {

/// One contour as it stands in the file: "CLOSED_PLANAR" ..., and x y z x y z ... in ct, mm.
struct RtContour {
    std::string type;
    std::vector<double> numbers;
};

/// Whether it bounds an area: also where it is cut out of the one around it (CLOSEDPLANAR_XOR).
bool is_closed(const RtContour& contour);

/// A region of interest of a structure set.
struct RtRoi {
    std::string name, description, frame_of_reference_uid;
    std::string interpreted_type;  ///< "ORGAN", "EXTERNAL", "PTV" ... (RT ROI Interpreted Type); empty when not said
    std::vector<double> colour;    ///< 0..255; empty when not given
    std::vector<RtContour> contours;
};

/// What a radiotherapy system draws beside organs, by the ROI's type (DICOM PS3.3 C.8.8.8), in words: "a marker". Empty
/// for an organ, and where no type is said.
std::string no_organ(const RtRoi& roi);

struct RtStruct {
    SeriesIdentity identity;                     ///< its patient, and its own study and series
    std::vector<std::string> referenced_series;  ///< UIDs of the series that it was drawn on, as far as it says
    bool ours = false;                           ///< written by Planlight, whose Patient ID is the case's code
    std::string frame_of_reference_uid;          ///< of all its ROIs
    std::vector<RtRoi> rois;                     ///< one at least
};

/// True when the first 4 KiB of the file name the class of RT Structure Sets.
bool is_rt_struct(const std::filesystem::path& file);

/// Reads a DICOM RT Structure Set in a child process. Throws InputError for another kind of DICOM, none or doubled
/// ROIs, two frames of reference or a coordinate that is no number, DamagedFileError for a cut file or one whose
/// numbers do not fit each other.
RtStruct read_rt_struct(const std::filesystem::path& file);

}  // namespace planlight
