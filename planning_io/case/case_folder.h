#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "planning_io/case/case_names.h"
#include "planning_io/types/plan.h"
#include "planning_io/types/registration_result.h"
#include "planning_io/types/skin_lut.h"
#include "planning_io/types/triangle_mesh.h"

namespace planlight {

/// Where sessions keep their matches, in the case folder.
constexpr const char* kRegistrationsFolder = "registrations";
/// Where they are recorded, in the case folder.
constexpr const char* kRecordingsFolder = "recordings";

/// All that the operating room needs of one patient: case.json (manifest with checksums), skin.ply, skin.lut,
/// plan.mrk.json, risk-1.ply ... of the plan's risk structures.
struct Case {
    std::string code;     ///< `code_of` its volume and plan; never a patient's name
    CaseNames names;      ///< for people
    std::string created;  ///< ISO 8601
    std::string source;   ///< Volume::source
    std::string volume_hash;
    std::string plan_hash;               ///< empty in cases of older versions
    std::string frame_of_reference_uid;  ///< Volume::frame_of_reference_uid; empty when the volume has none
    double skin_threshold = 0;           ///< 0 of a surface that somebody else segmented
    double skin_edge_sigma_mm = 0;       ///< how far noise moves the skin along its normal; 0 = not known
    TriangleMesh skin;
    SkinLut lut;
    Plan plan;
    std::vector<std::string> warnings;  ///< of the preparation, in words
};

/// What other files call this case.
CaseName name_of(const Case& prepared);

/// "1a2b3c4d-9f3e": the volume's first eight digits and the plan's first four.
std::string code_of(const std::string& volume_hash, const std::string& plan_hash);

/// One line by which people know the case: "E. M., frontal defect, version 2"; with the code where no patient is named.
std::string title_of(const Case& the_case);

/// Throws what `write_case` would because of what is there already: to be asked before long work.
void check_case_place(const std::filesystem::path& folder, bool replace);

/// Writes the folder so that it is whole or not there: into a temporary folder beside it, synced, then renamed. `add`
/// may write further files into that folder first (the report); checksums are made of all. A link is followed. An
/// existing case is replaced only with `replace`, and only when the folder holds nothing but a case: any other existing
/// folder is refused, a case with files that are not its own, and one that holds matches kept by sessions or their
/// recordings (`kRegistrationsFolder`, `kRecordingsFolder`).
void write_case(const Case& prepared, const std::filesystem::path& folder, bool replace = false,
                const std::function<void(const std::filesystem::path& into)>& add = {});

/// Reads and verifies: the checksum of every file that has one, and that LUT, mesh and manifest name the same patient.
/// A LUT of another case is refused with InputError, a damaged file with DamagedFileError.
Case read_case(const std::filesystem::path& folder);

}  // namespace planlight
