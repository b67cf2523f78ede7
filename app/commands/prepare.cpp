#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <optional>

#include "app/case_model.h"
#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/commands/language_option.h"
#include "app/commands/pdf_option.h"
#include "app/commands/plan_options.h"
#include "app/console.h"
#include "app/live/live_window.h"
#include "app/prepare_case.h"
#include "app/report/preparation_report.h"
#include "app/report/thresholds_picture.h"
#include "planning_io/files/image_file.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/surface/surface_fit.h"
#include "planning_io/types/error.h"
#include "planning_io/types/spare_memory.h"
#include "planning_io/volume/read_volume.h"
#include "segmentation/skin_threshold.h"

namespace planlight {
namespace {

struct PrepareOptions {
    Path volume, plan, out, pdf;
    std::vector<Path> risk;  ///< files of risk structures
    std::string series_uid;
    std::string frame, accept_frame;  ///< of a plan that does not say its coordinate system; a DICOM frame of reference
    std::string risk_frame;           ///< of risk structures that do not say theirs
    Path surface;                     ///< to project on, instead of the skin
    std::string surface_frame, segment;
    std::optional<double> threshold;  ///< HU; not given: found from the histogram
    double voxel_mm = 1;
    CaseNames names;         ///< the series' are the volume's
    bool anonymous = false;  ///< no UID and no file name of the volume in the case folder
    bool resample = false;   ///< slices with uneven steps onto an even grid
    bool phantom = false;    ///< not a head: a phantom, a dry skull or a plate, to commission a room
    bool replace = false, preview = false, json = false;
};

/// All that is read before anything is computed.
struct Inputs {
    Volume volume;
    PlanImport plan;
    std::optional<SurfaceFile> surface;
};

/// What was noted of files names them: of a folder's files, too.
void leave_out_names(std::vector<std::string>& notes, const std::vector<Path>& files) {
    std::vector<std::string> names;
    for (const Path& file : files) {
        names.insert(names.end(), {file.string(), file.filename().string()});
        std::error_code ignored;
        for (const auto& entry : std::filesystem::directory_iterator(file, ignored))
            names.push_back(entry.path().filename().string());
    }
    std::erase(names, "");
    std::sort(names.begin(), names.end(),  // a name may be part of another
              [](const std::string& a, const std::string& b) { return a.size() > b.size(); });
    const std::string instead = "a file";
    for (std::string& note : notes)
        for (const std::string& name : names)
            for (std::size_t at = 0; (at = note.find(name, at)) != std::string::npos; at += instead.size())
                note.replace(at, name.size(), instead);
}

void make_anonymous(Inputs& in, const PrepareOptions& options) {
    make_anonymous(in.volume);
    std::vector<Path> of_plan = options.risk;
    of_plan.push_back(options.plan);
    leave_out_names(in.plan.notes, of_plan);
    // What is called after its file; a structure of an RT Structure Set has a name of its own.
    std::vector<RiskStructure>& structures = in.plan.plan.risk_structures;
    for (std::size_t i = 0; i < structures.size(); ++i)
        for (const Path& file : options.risk)
            if (structures[i].name.starts_with(plan_name_of(file)))
                structures[i].name = fmt::format("structure {}", i + 1);
    if (in.surface) leave_out_names(in.surface->notes, {options.surface});
}

Inputs read_inputs(const PrepareOptions& options) {
    Inputs in;
    SeriesIdentity whose;
    in.volume = read_volume(options.volume, options.series_uid,
                            options.resample ? SliceGaps::resampled : SliceGaps::refused, &whose);
    const std::string& frame_uid = in.volume.frame_of_reference_uid;
    const PlanImportSettings said = plan_settings(options.frame, options.accept_frame, frame_uid, whose);
    in.plan = import_plan(options.plan, said);
    add_risk_structures(in.plan, options.risk, options.risk_frame, said);
    if (!options.surface.empty()) {
        in.surface = read_surface(
            options.surface,
            {plan_settings(options.surface_frame, options.accept_frame, frame_uid, whose), options.segment});
        const SurfaceFit fit = check_surface_fits(in.surface->mesh, in.volume, options.surface);
        if (std::string doubt = doubt_of(fit, options.surface); !doubt.empty())
            in.surface->notes.push_back(std::move(doubt));
    }
    if (options.anonymous) make_anonymous(in, options);
    return in;
}

/// The plan's name is its file's where none is given; an anonymous case does not take over the names of files.
CaseNames names_of(const PrepareOptions& options) {
    CaseNames names = options.names;
    if (names.plan.empty() && !options.anonymous) names.plan = fit_to_be_a_name(plan_name_of(options.plan));
    return names;
}

Preparation prepare(const Inputs& in, const PrepareOptions& options, ProgressBar& bar) {
    SkinSettings skin;
    skin.threshold = options.threshold.value_or(0);
    skin.phantom = options.phantom;
    LutSettings lut;
    lut.voxel_mm = options.voxel_mm;
    check_memory_to_prepare(in.volume, lut);
    const auto told = [&bar](const std::string& warning) { bar.warn(warning); };
    for (const auto& note : in.plan.notes) told(note);
    const auto show_thresholds = [&](const Volume& volume, double threshold) {
        Path picture = options.out;
        picture += ".thresholds.png";
        write_png(thresholds_picture(volume, skin, threshold), picture);
        bar.note(fmt::format("The skin at {}, {} and {} side by side: {}", threshold_text(kLowerThreshold * threshold),
                             threshold_text(threshold), threshold_text(kHigherThreshold * threshold),
                             picture.string()));
    };
    const PreparationWatcher watcher{bar.callback(), told, show_thresholds};
    Preparation done = in.surface ? prepare_case_on(in.volume, *in.surface, in.plan.plan, lut, iso_date_now(), watcher,
                                                    names_of(options), in.plan.said_frame)
                                  : prepare_case(in.volume, in.plan.plan, skin, lut, iso_date_now(), watcher,
                                                 names_of(options), in.plan.said_frame);
    done.prepared.warnings.insert(done.prepared.warnings.end(), in.plan.notes.begin(), in.plan.notes.end());
    return done;
}

/// The volume is given up when its pictures are made: the views take as much memory as it does.
PreparationReport report_of(Inputs& in, Preparation& done, bool anonymous, ProgressBar& bar) {
    bar.show("report", 0);
    PreparationPictures pictures;
    add_slices(in.volume, done.prepared, pictures);
    const RemovedPieces removed = find_removed_pieces(in.volume, done.mask);
    in.volume.values = {};
    done.mask.body = {};
    release_spare_memory();
    add_views(done.prepared, done.drawing, pictures);
    if (!pictures.no_views.empty()) bar.warn(pictures.no_views);
    PreparationReport report =
        preparation_report(done, done.drawing, removed, pictures, anonymous ? "" : operator_name());
    release_spare_memory();
    bar.show("report", 1);
    return report;
}

void print_summary(const Preparation& done, const PrepareOptions& options) {
    const Case& c = done.prepared;
    fmt::print("{}\nCase {} in {}: {}, {} triangles, LUT {} x {} x {} voxels of {:.2f} mm, {} plan item{}.\n",
               title_of(c), c.code, options.out.string(),
               done.on_given_surface ? "on the surface given" : "skin at " + threshold_text(done.threshold),
               c.skin.triangles.size(), c.lut.size[0], c.lut.size[1], c.lut.size[2], c.lut.voxel_mm, c.plan.size(),
               c.plan.size() == 1 ? "" : "s");
    fmt::print("Report: {}\n", (options.out / "report.html").string());
}

void check_threshold(const std::optional<double>& threshold) {
    if (threshold && (*threshold == 0 || !std::isfinite(*threshold)))
        throw Error(ExitCode::usage, fmt::format("--threshold {} is no level between air and skin", *threshold),
                    "Leave it out, so that it is found, or give one between them (of a CT in HU about -300).");
}

int run_prepare(const PrepareOptions& options) {
    check_threshold(options.threshold);
    check_case_names(options.names);
    check_case_place(options.out, options.replace);
    check_pdf(options.pdf, options.out);
    ProgressBar bar;
    bar.show("volume", 0);
    Inputs in = read_inputs(options);
    bar.show("volume", 1);
    Preparation done = prepare(in, options, bar);
    const PreparationReport report = report_of(in, done, options.anonymous, bar);
    bar.show("case folder", 0);
    const bool in_the_case = !options.pdf.empty() && stands_in(options.pdf, options.out);  // and so a file of its own
    write_case(done.prepared, options.out, options.replace, [&](const Path& into) {
        write_preparation_report(report, into);
        if (in_the_case)
            write_pdf(report.document, into / options.pdf.filename());
        else
            write_pdf(report.document, options.pdf, ReadableBy::owner);  // with the face and the name
    });
    bar.show("case folder", 1);
    if (options.json)
        std::cout << report.json;
    else
        print_summary(done, options);
    if (options.preview)
        show_model(model_of_case(done.prepared, CaseDrawing(done.prepared)), FitView::after,
                   settings_of_window({}, {}, read_site_settings()));
    return 0;
}

}  // namespace

Run add_prepare(CLI::App& app) {
    const auto options = std::make_shared<PrepareOptions>();
    PrepareOptions& o = *options;
    auto* sub =
        add_command(app, "prepare", "CT or MR volume and plan -> case folder (skin, LUT, plan, checksums)",
                    "prepare Cranium.inv3 --plan frontal_defect.mrk.json --out case\n"
                    "  planlight prepare Cranium.inv3 --plan frontal_defect.mrk.json --out case --pdf case/report.pdf");
    sub->add_option("volume", o.volume,
                    "DICOM folder or file, NIfTI, FreeSurfer MGZ, NRRD, MetaImage, or InVesalius project (.inv3)")
        ->required();
    sub->add_option("--plan", o.plan, "Plan file, or a folder of them: .mrk.json, .fcsv, RTSTRUCT, tables, lines")
        ->required();
    risk_options(sub, o.risk, o.risk_frame);
    plan_frame_options(sub, o.frame, o.accept_frame);
    auto* surface =
        sub->add_option("--surface", o.surface,
                        "Surface to project on instead of the skin: bone, or any other (.stl, .ply, .obj, .vtp, .vtk, "
                        "DICOM SEG or RTSTRUCT)");
    sub->add_option("--surface-frame", o.surface_frame, "Coordinate system of a surface that does not say its own")
        ->check(CLI::IsMember({"LPS", "RAS"}))
        ->needs(surface);
    sub->add_option("--segment", o.segment, "Which segment or ROI of a DICOM SEG or RTSTRUCT, by its name")
        ->needs(surface);
    sub->add_option("--out", o.out, "Case folder to write")->required();
    series_option(sub, o.series_uid);
    sub->add_option("--title", o.names.title, "What the case is called, in every window and on every page");
    auto* patient =
        sub->add_option("--patient", o.names.patient, "The patient's initials or code, as your site sets them");
    sub->add_option("--plan-name", o.names.plan, "What the plan is called (default: its file's name)");
    sub->add_option("--plan-version", o.names.plan_version, "Which version of the plan it is");
    sub->add_flag("--anonymous", o.anonymous,
                  "Leave UIDs, dates, descriptions, the operator and names of files and series out of the case folder")
        ->excludes(patient);
    sub->add_option("--threshold", o.threshold, "Skin threshold, HU (default: found from the histogram)")
        ->excludes(surface);
    sub->add_flag("--resample", o.resample,
                  "Lay DICOM slices with uneven steps onto an even grid, between the cuts where they lie");
    sub->add_flag("--phantom", o.phantom, "Take a phantom, a dry skull or a plate: do not ask whether it is a head")
        ->excludes(surface);
    sub->add_option("--voxel-mm", o.voxel_mm, "Edge of the LUT's cubic voxels")
        ->capture_default_str()
        ->check(CLI::Range(0.25, 10.0));
    sub->add_flag("--replace", o.replace, "Replace an existing case folder");
    sub->add_flag("--preview", o.preview, "Open the operator window on the result");
    pdf_option(sub, o.pdf);
    json_flag(sub, o.json);
    return [options] { return run_prepare(*options); };
}

}  // namespace planlight
