#include <fmt/format.h>

#include <iostream>
#include <optional>

#include "app/commands/commands.h"
#include "app/commands/plan_options.h"
#include "app/console.h"
#include "app/live/case_model.h"
#include "app/live/live_window.h"
#include "app/prepare_case.h"
#include "app/report/preparation_report.h"
#include "planning_io/read_volume.h"

namespace planlight {

int run_prepare(const PrepareOptions& options) {
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

}  // namespace planlight
