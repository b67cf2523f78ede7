#include "planning_io/case/case_folder.h"

#include <map>
#include <sstream>

#include "planning_io/case/skin_lut_file.h"
#include "planning_io/files/content_hash.h"
#include "planning_io/files/json_value.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/surface/mesh_file.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFormat = "planlight case";
constexpr int kVersion = 1;
constexpr const char* kManifest = "case.json";
constexpr const char* kSkinMesh = "skin.ply";
constexpr const char* kLutFile = "skin.lut";
constexpr const char* kPlanFile = "plan.mrk.json";
constexpr const char* kChecksums = "checksums.xxh128";  // as `xxh128sum` writes and checks it
constexpr const char* kPrepare = "Prepare the case again, or copy its folder again.";

Json manifest_of(const Case& prepared) {
    return Json{{"format", kFormat},
                {"version", kVersion},
                {"code", prepared.code},
                {"created", prepared.created},
                {"source", prepared.source},
                {"volume_hash", prepared.volume_hash},
                {"frame_of_reference_uid", prepared.frame_of_reference_uid},
                {"mesh_hash", hash_of(prepared.skin)},
                {"skin_threshold", prepared.skin_threshold},
                {"skin_edge_sigma_mm", prepared.skin_edge_sigma_mm},
                {"warnings", prepared.warnings}};
}

/// Name -> checksum, of the lines "CHECKSUM  NAME".
std::map<std::string, std::string> read_checksums(const fs::path& file) {
    std::map<std::string, std::string> checksums;
    std::istringstream lines(read_whole(file));
    for (std::string line; std::getline(lines, line);) {
        const auto gap = line.find("  ");
        if (gap == std::string::npos) throw DamagedFileError(file, "is damaged", kPrepare);
        checksums[line.substr(gap + 2)] = line.substr(0, gap);
    }
    return checksums;
}

class CheckedFolder {
public:
    explicit CheckedFolder(const fs::path& folder) : folder_(folder) {
        if (!fs::is_directory(folder))
            throw InputError(folder, "is not a case folder", "Name a folder that `planlight prepare` made.");
        for (const char* name : {kManifest, kSkinMesh, kLutFile, kPlanFile, kChecksums})
            if (!fs::exists(folder / name)) {
                if (!fs::exists(folder / kManifest))
                    throw InputError(folder, "is not a case folder", "Name a folder that `planlight prepare` made.");
                throw DamagedFileError(folder / name, "is missing", kPrepare);
            }
        checksums_ = read_checksums(folder / kChecksums);
    }
    fs::path path(const char* name) const { return folder_ / name; }
    void verify(const char* name) const {
        const auto expected = checksums_.find(name);
        if (expected == checksums_.end() || expected->second != content_hash(read_whole(path(name))))
            throw DamagedFileError(path(name), "is not the file that was prepared (its checksum differs)", kPrepare);
    }

private:
    fs::path folder_;
    std::map<std::string, std::string> checksums_;
};

void check_same_patient(const Case& prepared, const std::string& mesh_hash, const CheckedFolder& folder) {
    if (hash_of(prepared.skin) != mesh_hash)
        throw InputError(folder.path(kSkinMesh), "is the skin of another case", kPrepare);
    if (prepared.lut.volume_hash != prepared.volume_hash || prepared.lut.mesh_hash != mesh_hash)
        throw InputError(folder.path(kLutFile), "is the LUT of another case", kPrepare);
}

}  // namespace

CaseName name_of(const Case& prepared) {
    return {prepared.code, prepared.volume_hash, prepared.lut.mesh_hash};
}

void write_case(const Case& prepared, const fs::path& folder, bool replace) {
    if (prepared.lut.volume_hash != prepared.volume_hash || prepared.lut.mesh_hash != hash_of(prepared.skin))
        throw InputError(folder, "would hold the LUT of another case",
                         "Build the LUT from this case's volume and skin.");
    if (replace && fs::exists(folder) && !fs::exists(folder / kManifest))
        replace = false;  // only a case is ever replaced
    if (replace && fs::exists(folder / kRegistrationsFolder))
        throw InputError(folder,
                         std::string("holds matches that sessions kept (") + kRegistrationsFolder +
                             "), which would be lost with the case that is replaced",
                         "Move that folder away, or name another folder for the new case.");
    write_folder_safely(folder, replace, [&](const fs::path& into) {
        write_safely(into / kManifest, dump(manifest_of(prepared)));
        write_mesh(prepared.skin, into / kSkinMesh);
        write_skin_lut(prepared.lut, into / kLutFile);
        write_plan(prepared.plan, into / kPlanFile);
        std::string checksums;
        for (const char* name : {kManifest, kSkinMesh, kLutFile, kPlanFile})
            checksums += content_hash(read_whole(into / name)) + "  " + name + "\n";
        write_safely(into / kChecksums, checksums);
    });
}

Case read_case(const fs::path& folder) {
    const CheckedFolder files(folder);
    files.verify(kManifest);
    const fs::path manifest_file = files.path(kManifest);
    const Json json = parse_json(read_whole(manifest_file), manifest_file);
    const JsonValue manifest(json, manifest_file);
    check_format(manifest, kFormat, kVersion, manifest_file);
    Case prepared;
    prepared.code = manifest.at("code").text();
    prepared.created = manifest.at("created").text();
    prepared.source = manifest.at("source").text();
    prepared.volume_hash = manifest.at("volume_hash").text();
    if (const auto uid = manifest.find("frame_of_reference_uid")) prepared.frame_of_reference_uid = uid->text();
    prepared.skin_threshold = manifest.at("skin_threshold").number();
    if (const auto sigma = manifest.find("skin_edge_sigma_mm")) prepared.skin_edge_sigma_mm = sigma->number();
    const JsonValue warnings = manifest.at("warnings");
    for (std::size_t i = 0; i < warnings.size(); ++i) prepared.warnings.push_back(warnings[i].text());

    // Whole files of another case are told apart from damaged ones, so identity is looked at before the checksums.
    prepared.lut = read_skin_lut(files.path(kLutFile));
    prepared.skin = read_mesh(files.path(kSkinMesh));
    check_same_patient(prepared, manifest.at("mesh_hash").text(), files);
    for (const char* name : {kSkinMesh, kLutFile, kPlanFile}) files.verify(name);
    prepared.plan = read_plan(files.path(kPlanFile));
    return prepared;
}

}  // namespace planlight
