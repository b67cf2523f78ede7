#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "app/belonging.h"
#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/console.h"
#include "app/export/export_study.h"
#include "app/export/match_that_stood.h"
#include "app/json_text.h"
#include "app/report/operation_comparison.h"
#include "planning_io/case/case_folder.h"
#include "planning_io/case/registration_file.h"
#include "planning_io/surface/mesh_file.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

struct ExportOptions {
    Path case_folder, recording, registration, cloud;
    Path dicom, volume;
    std::string series_uid;
    Path slicer;
    bool json = false;
};

/// The scan of a match, among those that sessions kept beside the case; empty where it is not there.
Path kept_cloud(const Path& case_folder, const RegistrationResult& match) {
    std::error_code fault;
    for (fs::directory_iterator entry(case_folder / kRegistrationsFolder, fault), end; !fault && entry != end;
         entry.increment(fault)) {
        try {
            const RegistrationResult kept = read_registration(entry->path() / "registration.json");
            if (kept.patient_from_ct.isApprox(match.patient_from_ct, 1e-12) &&
                fs::exists(entry->path() / "cloud.ply", fault))
                return entry->path() / "cloud.ply";
        } catch (const Error&) {  // another one may be sound
        }
    }
    return {};
}

ExportedOperation operation_of(const ExportOptions& options, const Case& the_case) {
    ExportedOperation operation;
    Path cloud = options.cloud, file = options.registration;
    if (!options.recording.empty()) {
        MatchThatStood stood = match_that_stood(options.recording);
        if (stood.scanned_later)
            warn("a later scan of that session came to no match: what is written is the match before it");
        operation.match = std::move(stood.match.registration);
        operation.made = stood.match.made_utc;
        operation.facts = facts_of_operation(options.recording);
        if (operation.facts->damaged)
            throw DamagedFileError(options.recording,
                                   "is damaged: the archive's report would lack what stands behind the damage",
                                   "Copy the recording again from where it was made, or export the match alone "
                                   "(--registration).");
        compare_moment(*operation.facts, options.recording, the_case);
        file = options.recording;
    } else {
        operation.match = read_registration(file);
        if (operation.match.verdict == Verdict::no)
            throw InputError(file, "says that the patient was not found", "Name a match that may be used.");
        operation.confirmed = operation.match.verdict == Verdict::yes;
        if (!operation.confirmed)
            warn(
                fmt::format("the match was not sure, and nothing says that somebody looked at the light ({}): what is "
                            "written calls it NOT CONFIRMED",
                            fmt::join(operation.match.reasons, "; ")));
    }
    std::vector<std::string> unknown;
    check_case(operation.match, the_case, file, unknown);
    for (const std::string& what : unknown) warn(what);
    if (cloud.empty()) cloud = kept_cloud(options.case_folder, operation.match);
    if (cloud.empty())
        warn("the scan of this match is not in " + (options.case_folder / kRegistrationsFolder).string() +
             ": it is left out");
    else
        operation.cloud = read_cloud_of(operation.match, cloud, file);
    return operation;
}

int run_export(const ExportOptions& options) {
    if (options.dicom.empty() && options.slicer.empty())
        throw Error(ExitCode::usage, "nothing says what is to be written",
                    "Give --dicom FOLDER, --slicer FOLDER or both.");
    if (options.recording.empty() == options.registration.empty())
        throw Error(ExitCode::usage, "one match is wanted", "Give --recording FILE, or --registration FILE.");
    const Case the_case = read_case(options.case_folder);
    const ExportedOperation operation = operation_of(options, the_case);
    nlohmann::ordered_json told;
    if (!options.dicom.empty()) {
        told["dicom"] = export_into_study(the_case, operation, options.volume, options.series_uid, options.dicom);
        if (!options.json)
            fmt::print(
                "{} objects for the study of the planning series in {}. They name the patient and show the face.\n",
                told["dicom"].size(), options.dicom.string());
    }
    if (!options.slicer.empty()) {
        export_for_slicer(the_case, operation, options.slicer);
        told["slicer"] = (options.slicer / "scene.mrml").string();
        if (!options.json) fmt::print("{}: drag it into 3D Slicer.\n", (options.slicer / "scene.mrml").string());
    }
    if (options.json) std::cout << json_text(told) << '\n';
    return 0;
}

}  // namespace

Run add_export(CLI::App& app) {
    const auto options = std::make_shared<ExportOptions>();
    ExportOptions& o = *options;
    auto* sub = add_command(app, "export", "A match and its operation for other systems: DICOM objects, 3D Slicer",
                            "export case --recording session.plrec --slicer for-slicer");
    sub->add_option("case", o.case_folder, "Case folder")->required();
    auto* recording = sub->add_option("--recording", o.recording,
                                      "Recording of a session: the last match that stood, and its report");
    sub->add_option("--registration", o.registration, "Or a match alone (registration.json)")->excludes(recording);
    sub->add_option("--cloud", o.cloud,
                    "The scan that was matched (.ply; default: the one kept in CASE/registrations)");
    auto* volume = sub->add_option("--volume", o.volume, "Folder of the DICOM series that the case was made from");
    series_option(sub, o.series_uid);
    sub->add_option("--dicom", o.dicom,
                    "New folder for DICOM objects of that study: Spatial Registration, Encapsulated PDF (the report of "
                    "a recording), Secondary Capture (pictures)")
        ->needs(volume);
    sub->add_option("--slicer", o.slicer,
                    "New folder for 3D Slicer: skin, plan, scan, transform, and the plan as lines on the skin");
    json_flag(sub, o.json);
    return [options] { return run_export(*options); };
}

}  // namespace planlight
