#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planning_io/types/plan.h"
#include "planning_io/types/registration_result.h"
#include "planning_io/types/skin_lut.h"
#include "planning_io/types/triangle_mesh.h"

namespace planlight {

/// Where sessions keep their matches, in the case folder.
constexpr const char* kRegistrationsFolder = "registrations";

/// All that the operating room needs of one patient: case.json (manifest with checksums), skin.ply, skin.lut,
/// plan.mrk.json.
struct Case {
    std::string code;     ///< of the case, made from the volume's hash; never a patient's name
    std::string created;  ///< ISO 8601
    std::string source;   ///< Volume::source
    std::string volume_hash;
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

/// Writes the folder so that it is whole or not there: into a temporary folder beside it, synced, then renamed. An
/// existing case folder is replaced only with `replace`; any other existing folder is refused, and a case that holds
/// matches kept by sessions (`kRegistrationsFolder`).
void write_case(const Case& prepared, const std::filesystem::path& folder, bool replace = false);

/// Reads and verifies: every file's checksum, and that LUT, mesh and manifest name the same patient. A LUT of another
/// case is refused with InputError, a damaged file with DamagedFileError.
Case read_case(const std::filesystem::path& folder);

}  // namespace planlight
