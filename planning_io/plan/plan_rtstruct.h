#pragma once

#include <filesystem>
#include <string>

#include "planning_io/dicom/rt_struct.h"
#include "planning_io/plan/plan_import.h"

namespace planlight {

/// A plan from a DICOM RT Structure Set, parsed in a child process. Of each ROI: CLOSED_PLANAR contours are closed
/// osteotomy lines, OPEN_PLANAR and OPEN_NONPLANAR open ones, POINT boreholes ("diameter_mm=7 depth_mm=6" in the ROI's
/// description); names and colours are the ROI's. An ROI with contours at three heights or more is a solid, no line:
/// left out, and noted, as are ROIs without contours and those that are a marker, an isocentre or the like by their
/// type. Its frame of reference must be the CT's
/// (`settings.frame_of_reference_uid`). Files that `write_plan_rtstruct` wrote give every item back, to the 16
/// characters that DICOM has for a number.
PlanImport read_rtstruct(const std::filesystem::path& file, const PlanImportSettings& settings);

/// What an RTSTRUCT must say of the patient and the CT; never a name.
struct RtStructIdentity {
    std::string code;                    ///< of the case: Patient ID and label of the set
    std::string frame_of_reference_uid;  ///< of the CT
    std::string created;                 ///< ISO 8601
};

/// Writes the plan as DICOM RT Structure Set (implicit little endian). Throws InputError when the CT has no frame of
/// reference.
void write_plan_rtstruct(const Plan& plan, const RtStructIdentity& identity, const std::filesystem::path& file);

/// Throws InputError unless the frame of reference of a DICOM plan is that of the CT, as `settings` says it; not given,
/// it is noted as not checked.
void check_frame_of_reference(const std::string& uid_of_plan, const PlanImportSettings& settings,
                              const std::filesystem::path& file, std::vector<std::string>& notes);

/// The same of a structure set, which also says of which patient and on which series it was drawn: another patient is
/// an InputError unless `settings.accepted_frame_uid` is its frame; that, and another series, are noted.
void check_frame_of_reference(const RtStruct& set, const PlanImportSettings& settings,
                              const std::filesystem::path& file, std::vector<std::string>& notes);

}  // namespace planlight
