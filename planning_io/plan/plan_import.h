#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/plan/coordinate_space.h"
#include "planning_io/types/plan.h"

namespace planlight {

/// What a person, or the CT, says about a plan file.
struct PlanImportSettings {
    std::optional<Space> space;  ///< of files that do not say theirs; one that says another is refused
    /// FrameOfReferenceUID of the CT, to which that of a DICOM plan must be equal; "" = the CT has none, so that no
    /// DICOM plan fits it; not given = not checked (and noted).
    std::optional<std::string> frame_of_reference_uid;
    /// That a person says is the CT's as well; it is noted where it is used. "" = none.
    std::string accepted_frame_uid = {};
};

/// A plan with what was assumed or left out on the way.
struct PlanImport {
    Plan plan;
    std::string frame_of_reference_uid;  ///< that the DICOM plans are in, the CT's where another is accepted; or empty
    std::vector<std::string> notes;      ///< what was left out or assumed, a sentence each, with the file's name
};

/// Reads a plan file of any known kind, told by content and name (the room's README lists them), or a folder of them.
///
/// Frame and units must be said by the file or by `settings`: what is missing, wrong or means nothing in a plan is an
/// InputError with its name; a cut or garbled file a DamagedFileError. DICOM, VTK and VTP are parsed in a child
/// process.
PlanImport import_plan(const std::filesystem::path& file_or_folder, const PlanImportSettings& settings = {});

/// Adds the items of `more`; frames of reference must agree (InputError).
void append(PlanImport& to, PlanImport more);

}  // namespace planlight
