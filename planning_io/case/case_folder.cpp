#include "planning_io/case/case_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <sstream>

#include "planning_io/case/skin_lut_file.h"
#include "planning_io/files/check_exists.h"
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
constexpr std::array<const char*, 7> kOurFiles = {kManifest,  kSkinMesh,     kLutFile,     kPlanFile,
                                                  kChecksums, "report.html", "report.json"};
constexpr const char* kRiskStructure = "risk-";  // and its number, from 1, and ".ply"
constexpr const char* kPrepare = "Prepare the case again, or copy its folder again.";

Json names_json(const CaseNames& names) {
    return Json{{"title", names.title},   {"patient", names.patient},
                {"plan", names.plan},     {"plan_version", names.plan_version},
                {"series", names.series}, {"series_date", names.series_date}};
}

CaseNames names_of(const JsonValue& json) {
    const auto text = [&](const char* name) {
        const auto value = json.find(name);
        return value ? value->text() : std::string();
    };
    return {text("title"), text("patient"), text("plan"), text("plan_version"), text("series"), text("series_date")};
}

std::string risk_file(std::size_t number) {
    return fmt::format("{}{}.ply", kRiskStructure, number + 1);
}

Json risk_structures_json(const Plan& plan) {
    Json all = Json::array();
    for (std::size_t i = 0; i < plan.risk_structures.size(); ++i)
        all.push_back({{"name", plan.risk_structures[i].name}, {"file", risk_file(i)}});
    return all;
}

Json manifest_of(const Case& prepared) {
    return Json{{"format", kFormat},
                {"version", kVersion},
                {"code", prepared.code},
                {"names", names_json(prepared.names)},
                {"created", prepared.created},
                {"source", prepared.source},
                {"volume_hash", prepared.volume_hash},
                {"plan_hash", prepared.plan_hash},
                {"frame_of_reference_uid", prepared.frame_of_reference_uid},
                {"mesh_hash", hash_of(prepared.skin)},
                {"risk_structures", risk_structures_json(prepared.plan)},
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
        check_exists(folder, "Name a folder that `planlight prepare` made.");
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
    /// The files that have a checksum and are not read here: the report.
    void verify_others(std::initializer_list<const char*> read) const {
        for (const auto& [name, checksum] : checksums_) {
            if (std::find(read.begin(), read.end(), name) != read.end()) continue;
            if (fs::path(name).filename() != name) throw DamagedFileError(folder_ / kChecksums, "is damaged", kPrepare);
            if (!fs::exists(folder_ / name)) throw DamagedFileError(folder_ / name, "is missing", kPrepare);
            verify(name.c_str());
        }
    }
    void verify(const char* name) const {
        const auto expected = checksums_.find(name);
        if (expected == checksums_.end() || expected->second != content_hash_of(path(name)))
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

/// None in cases of older versions. Each must be the file that was prepared.
std::vector<RiskStructure> read_risk_structures(const JsonValue& manifest, const CheckedFolder& folder) {
    std::vector<RiskStructure> structures;
    const auto all = manifest.find("risk_structures");
    for (std::size_t i = 0; all && i < all->size(); ++i) {
        const std::string name = (*all)[i].at("file").text();
        if (name != risk_file(i)) (*all)[i].at("file").refuse("is not " + risk_file(i), kPrepare);
        if (!fs::exists(folder.path(name.c_str())))
            throw DamagedFileError(folder.path(name.c_str()), "is missing", kPrepare);
        folder.verify(name.c_str());
        structures.push_back({(*all)[i].at("name").text(), read_mesh(folder.path(name.c_str()))});
    }
    return structures;
}

/// Whether the case's own files can bear this name.
bool is_ours(const std::string& name) {
    if (std::find(kOurFiles.begin(), kOurFiles.end(), name) != kOurFiles.end()) return true;
    constexpr std::string_view kBefore = kRiskStructure, kAfter = ".ply";
    if (!name.starts_with(kBefore) || !name.ends_with(kAfter) || name.size() <= kBefore.size() + kAfter.size())
        return false;
    const auto number = std::string_view(name).substr(kBefore.size(), name.size() - kBefore.size() - kAfter.size());
    return std::all_of(number.begin(), number.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// Whether a folder holds a case, whole or damaged, by its manifest.
bool holds_case(const fs::path& folder) {
    std::error_code ignored;
    return fs::is_regular_file(folder / kManifest, ignored) &&
           read_whole(folder / kManifest).find(kFormat) != std::string::npos;
}

/// The files that a case's own checksums name (a report as PDF, say); none where these cannot be read.
std::set<std::string> written_with_case(const fs::path& folder) {
    std::set<std::string> names;
    try {
        if (fs::is_regular_file(folder / kChecksums))
            for (const auto& [name, checksum] : read_checksums(folder / kChecksums)) names.insert(name);
    } catch (const Error&) {  // what is not known to be ours is kept
    }
    return names;
}

/// Refuses to replace what cannot be made again: a session's matches, and files that are not the case's.
void check_nothing_is_lost(const fs::path& folder) {
    for (const auto& [name, what] : {std::pair{kRegistrationsFolder, "matches that sessions kept"},
                                     std::pair{kRecordingsFolder, "recordings of sessions"}})
        if (fs::exists(folder / name))
            throw InputError(
                folder, fmt::format("holds {} ({}), which would be lost with the case that is replaced", what, name),
                "Move that folder away, or name another folder for the new case.");
    const std::set<std::string> written = written_with_case(folder);
    std::string others;
    for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if ((is_ours(name) || written.contains(name)) && entry.is_regular_file()) continue;
        others += (others.empty() ? "" : ", ") + name;
    }
    if (!others.empty())
        throw InputError(folder, "holds what is not of the case and would be lost with it: " + others,
                         "Move it away, or name another folder for the new case.");
}

std::string checksums_in(const fs::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    std::string checksums;
    for (const auto& name : names) checksums += content_hash_of(folder / name) + "  " + name + "\n";
    return checksums;
}

}  // namespace

CaseName name_of(const Case& prepared) {
    return {prepared.code, prepared.volume_hash, prepared.lut.mesh_hash};
}

std::string code_of(const std::string& volume_hash, const std::string& plan_hash) {
    return volume_hash.substr(0, 8) + "-" + plan_hash.substr(0, 4);
}

std::string title_of(const Case& the_case) {
    const CaseNames& names = the_case.names;
    std::string title = names.title;
    const auto add = [&](const std::string& more) {
        if (!more.empty()) title += (title.empty() ? "" : ", ") + more;
    };
    add(names.patient);
    if (title.empty()) title = "Case " + the_case.code;
    add(names.plan);
    add(names.plan_version.empty() ? "" : "version " + names.plan_version);
    return title;
}

void check_case_place(const fs::path& folder, bool replace) {
    if (!fs::exists(folder) || (fs::is_directory(folder) && fs::is_empty(folder))) return check_new_folder(folder);
    if (!fs::is_directory(folder)) throw InputError(folder, "is a file, not a folder", "Name another folder.");
    if (!holds_case(folder))
        throw InputError(folder,
                         replace ? "holds no case: --replace replaces nothing else" : "exists already and is not empty",
                         "Name a new folder.");
    if (!replace)
        throw InputError(folder, "holds a case already",
                         "Name a new folder, or give --replace to put the new case in its place.");
    check_nothing_is_lost(folder);
    check_new_folder(folder);
}

void write_case(const Case& prepared, const fs::path& folder, bool replace,
                const std::function<void(const fs::path&)>& add) {
    if (prepared.lut.volume_hash != prepared.volume_hash || prepared.lut.mesh_hash != hash_of(prepared.skin))
        throw InputError(folder, "would hold the LUT of another case",
                         "Build the LUT from this case's volume and skin.");
    check_case_names(prepared.names);
    check_case_place(folder, replace);
    write_folder_safely(folder, replace, [&](const fs::path& into) {
        write_safely(into / kManifest, dump(manifest_of(prepared)));
        write_mesh(prepared.skin, into / kSkinMesh);
        write_skin_lut(prepared.lut, into / kLutFile);
        write_plan(prepared.plan, into / kPlanFile);
        for (std::size_t i = 0; i < prepared.plan.risk_structures.size(); ++i)
            write_mesh(prepared.plan.risk_structures[i].surface, into / risk_file(i));
        if (add) add(into);
        write_safely(into / kChecksums, checksums_in(into));
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
    if (const auto names = manifest.find("names")) prepared.names = names_of(*names);
    if (const auto hash = manifest.find("plan_hash")) prepared.plan_hash = hash->text();
    if (const auto uid = manifest.find("frame_of_reference_uid")) prepared.frame_of_reference_uid = uid->text();
    prepared.skin_threshold = manifest.at("skin_threshold").number();
    if (const auto sigma = manifest.find("skin_edge_sigma_mm")) prepared.skin_edge_sigma_mm = sigma->number();
    const JsonValue warnings = manifest.at("warnings");
    for (std::size_t i = 0; i < warnings.size(); ++i) prepared.warnings.push_back(warnings[i].text());

    // Whole files of another case are told apart from damaged ones, so identity is looked at before the checksums.
    prepared.lut = read_skin_lut(files.path(kLutFile));
    try {
        prepared.skin = read_mesh(files.path(kSkinMesh));
    } catch (const Error&) {
        files.verify(kSkinMesh);  // what cannot be read is the case's to mend, not the mesh's
        throw;
    }
    check_same_patient(prepared, manifest.at("mesh_hash").text(), files);
    for (const char* name : {kSkinMesh, kLutFile, kPlanFile}) files.verify(name);
    files.verify_others({kManifest, kSkinMesh, kLutFile, kPlanFile});
    prepared.plan = read_plan(files.path(kPlanFile));
    prepared.plan.risk_structures = read_risk_structures(manifest, files);
    if (!prepared.plan_hash.empty() && hash_of(prepared.plan) != prepared.plan_hash)
        throw InputError(files.path(kPlanFile), "is the plan of another case", kPrepare);
    return prepared;
}

}  // namespace planlight
