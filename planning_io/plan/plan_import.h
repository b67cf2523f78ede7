#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "planning_io/plan/coordinate_space.h"
#include "planning_io/types/plan.h"
#include "planning_io/types/series_identity.h"

namespace planlight {

/// What a person, or the CT, says about a plan file.
struct PlanImportSettings {
    std::optional<Space> space;  ///< of files that do not say theirs; one that says another is refused
    /// FrameOfReferenceUID of the CT, to which that of a DICOM plan must be equal; "" = the CT has none, so that no
    /// DICOM plan fits it; not given = not checked (and noted).
    std::optional<std::string> frame_of_reference_uid;
    /// That a person says is the CT's as well; it is noted where it is used. "" = none.
    std::string accepted_frame_uid = {};
    SeriesIdentity volume =
        {};  ///< whose the CT is, as far as it is known: what a structure set says is compared with it
    /// Of a plan of several files `space` is for those that do not say theirs; one that says another is noted.
    bool one_of_several = false;
};

/// Items whose frame a person says and their files do not: whether the person is right, nothing in them tells.
struct SaidFrame {
    std::optional<Space> space;  ///< empty: there are none
    Plan items;
};

/// A plan with what was assumed or left out on the way.
struct PlanImport {
    Plan plan;
    std::string frame_of_reference_uid;  ///< that the DICOM plans are in, the CT's where another is accepted; or empty
    std::vector<std::string> notes;      ///< what was left out or assumed, a sentence each, with the file's name
    bool says_other_space = false;       ///< a file, than a person says
    SaidFrame said_frame;
};

/// Reads a plan file of any known kind, told by content and name (the room's README lists them), or a folder of them.
///
/// Frame and units must be said by the file or by `settings`: what is missing, wrong or means nothing in a plan is an
/// InputError with its name; a cut or garbled file a DamagedFileError. DICOM, VTK and VTP are parsed in a child
/// process.
PlanImport import_plan(const std::filesystem::path& file_or_folder, const PlanImportSettings& settings = {});

/// The same of several files or folders that are one plan.
PlanImport import_plan(const std::vector<std::filesystem::path>& files, PlanImportSettings settings);

/// `settled_space` of a plan's file; what a person said of it is noted in `read`.
Space space_of_plan(const SpaceSaid& file_says, const PlanImportSettings& settings, const std::filesystem::path& file,
                    std::string_view how_to_say, PlanImport& read);

/// Adds the items of `more`; frames of reference must agree (InputError).
void append(PlanImport& to, PlanImport more);

}  // namespace planlight
