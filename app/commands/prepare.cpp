#include <fmt/format.h>

#include <iostream>
#include <optional>

#include "app/case_model.h"
#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/commands/plan_options.h"
#include "app/console.h"
#include "app/live/live_window.h"
#include "app/prepare_case.h"
#include "app/report/preparation_report.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"

namespace planlight {
namespace {

struct PrepareOptions {
    Path volume, plan, out;
    std::string series_uid;
    std::string frame, accept_frame;  ///< of a plan that does not say its coordinate system; a DICOM frame of reference
    Path surface;                     ///< to project on, instead of the skin
    std::string surface_frame, segment;
    double threshold = 0;  ///< HU; 0 = found from the histogram
    double voxel_mm = 1;
    bool anonymous = false;  ///< no UID and no file name of the volume in the case folder
    bool replace = false, preview = false, json = false;
};

/// Before the work, not after it.
void check_out(const PrepareOptions& options) {
    if (options.replace || !std::filesystem::exists(options.out / "case.json")) return;
    throw InputError(options.out, "is a case already", "Name a new folder, or replace this case with --replace.");
}

int run_prepare(const PrepareOptions& options) {
    check_out(options);
    ProgressBar bar;
    bar.show("volume", 0);
    Volume volume = read_volume(options.volume, options.series_uid);
    const PlanImport plan =
        import_plan(options.plan, plan_settings(options.frame, options.accept_frame, volume.frame_of_reference_uid));
    std::optional<SurfaceFile> surface;
    if (!options.surface.empty()) {
        surface = read_surface(
            options.surface, {plan_settings(options.surface_frame, options.accept_frame, volume.frame_of_reference_uid),
                              options.segment});
        check_surface_fits(surface->mesh, volume, options.surface);
    }
    if (options.anonymous) make_anonymous(volume);
    bar.show("volume", 1);
    SkinSettings skin;
    skin.threshold = options.threshold;
    LutSettings lut;
    lut.voxel_mm = options.voxel_mm;
    Preparation done = surface ? prepare_case_on(volume, *surface, plan.plan, lut, iso_date_now(), bar.callback())
                               : prepare_case(volume, plan.plan, skin, lut, iso_date_now(), bar.callback());
    done.prepared.warnings.insert(done.prepared.warnings.end(), plan.notes.begin(), plan.notes.end());
    bar.show("case folder", 0);
    write_case(done.prepared, options.out, options.replace);
    bar.show("case folder", 1);
    const Case& the_case = done.prepared;
    const CaseDrawing drawing(the_case);
    bar.show("report", 0);
    std::string no_views;
    write_preparation_report(options.out, done, drawing.drawing,
                             preparation_pictures(volume, the_case, drawing.drawing, no_views));
    bar.show("report", 1);
    if (!no_views.empty()) warn(no_views);
    for (const auto& warning : the_case.warnings) warn(warning);
    if (options.json) {
        std::cout << preparation_json(done, drawing.drawing);
    } else {
        fmt::print("Case {} in {}: {}, {} triangles, LUT {} x {} x {} voxels of {:.2f} mm, {} plan items.\n",
                   the_case.code, options.out.string(),
                   surface ? "on the surface given" : fmt::format("skin at {:.0f}", done.threshold),
                   the_case.skin.triangles.size(), the_case.lut.size[0], the_case.lut.size[1], the_case.lut.size[2],
                   the_case.lut.voxel_mm, the_case.plan.size());
        fmt::print("Report: {}\n", (options.out / "report.html").string());
    }
    if (options.preview) show_model(model_of_case(the_case, drawing));
    return 0;
}

}  // namespace

Run add_prepare(CLI::App& app) {
    const auto options = std::make_shared<PrepareOptions>();
    PrepareOptions& o = *options;
    auto* sub = add_command(app, "prepare", "CT or MR volume and plan -> case folder (skin, LUT, plan, checksums)",
                            "prepare Cranium.inv3 --plan frontal_defect.mrk.json --out case");
    sub->add_option("volume", o.volume, "DICOM folder or file, NIfTI, NRRD, MetaImage, or InVesalius project (.inv3)")
        ->required();
    sub->add_option("--plan", o.plan, "Plan file, or a folder of them: .mrk.json, .fcsv, RTSTRUCT, tables, lines")
        ->required();
    plan_frame_options(sub, o.frame, o.accept_frame);
    sub->add_option("--surface", o.surface,
                    "Surface to project on instead of the skin: bone, or any other (.stl, .ply, .obj, .vtp, .vtk, "
                    "DICOM SEG or RTSTRUCT)");
    sub->add_option("--surface-frame", o.surface_frame, "Coordinate system of a surface that does not say its own")
        ->check(CLI::IsMember({"LPS", "RAS"}));
    sub->add_option("--segment", o.segment, "Which segment or ROI of a DICOM SEG or RTSTRUCT, by its name");
    sub->add_option("--out", o.out, "Case folder to write")->required();
    series_option(sub, o.series_uid);
    sub->add_flag("--anonymous", o.anonymous, "Leave UIDs and file names of the volume out of the case folder");
    sub->add_option("--threshold", o.threshold, "Skin threshold, HU (default: found from the histogram)");
    sub->add_option("--voxel-mm", o.voxel_mm, "Edge of the LUT's cubic voxels")
        ->capture_default_str()
        ->check(CLI::Range(0.25, 10.0));
    sub->add_flag("--replace", o.replace, "Replace an existing case folder");
    sub->add_flag("--preview", o.preview, "Open the operator window on the result");
    json_flag(sub, o.json);
    return [options] { return run_prepare(*options); };
}

}  // namespace planlight
