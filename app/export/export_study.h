#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/report/operation_report.h"
#include "planning_io/case/case_folder.h"
#include "planning_io/types/point_cloud.h"
#include "planning_io/types/registration_result.h"

namespace planlight {

/// What there is of an operation to be handed to other systems.
struct ExportedOperation {
    RegistrationResult match;
    bool confirmed = true;                ///< it was sure, or a person looked at it
    std::string made;                     ///< of the match, ISO 8601, UTC
    std::optional<PointCloud> cloud;      ///< the scan that was matched, rig
    std::optional<OperationFacts> facts;  ///< of its recording
};

/// The match as Spatial Registration, the operation's report as Encapsulated PDF and pictures as Secondary Capture,
/// into the study of the planning series: new files in a new folder; gives their names. A series without a frame of
/// reference gets no Spatial Registration, which is warned of. Throws InputError where the case is of no DICOM series,
/// or `series_folder` holds another one than the case was made from.
std::vector<std::string> export_into_study(const Case& the_case, const ExportedOperation& operation,
                                           const std::filesystem::path& series_folder, const std::string& series,
                                           const std::filesystem::path& folder);

/// The same as a folder that 3D Slicer opens (`write_slicer_scene`), with the whole plan as lines on the
/// skin: also what a person hid during the operation.
void export_for_slicer(const Case& the_case, const ExportedOperation& operation, const std::filesystem::path& folder);

}  // namespace planlight
