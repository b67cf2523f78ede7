#include <fmt/format.h>

#include <iostream>

#include "app/commands/commands.h"
#include "app/console.h"
#include "app/live/live_window.h"
#include "app/prepare_case.h"
#include "app/report/preparation_report.h"
#include "planning_io/plan_file.h"
#include "planning_io/read_volume.h"

namespace planlight {

int run_prepare(const PrepareOptions& options) {
    ProgressBar bar;
    bar.show("volume", 0);
    const Plan plan = read_plan(options.plan);
    Volume volume = read_volume(options.volume, options.series_uid);
    if (options.anonymous) make_anonymous(volume);
    bar.show("volume", 1);
    SkinSettings skin;
    skin.threshold = options.threshold;
    LutSettings lut;
    lut.voxel_mm = options.voxel_mm;
    const Preparation done = prepare_case(volume, plan, skin, lut, iso_date_now(), bar.callback());
    bar.show("case folder", 0);
    write_case(done.prepared, options.out, options.replace);
    bar.show("case folder", 1);
    const Case& the_case = done.prepared;
    const CaseDrawing drawing(the_case);
    bar.show("report", 0);
    std::string no_views;
    write_preparation_report(options.out, done, drawing.drawing, preparation_pictures(volume, the_case, drawing.drawing, no_views));
    bar.show("report", 1);
    if (!no_views.empty()) warn(no_views);
    for (const auto& warning : the_case.warnings) warn(warning);
    if (options.json) {
        std::cout << preparation_json(done, drawing.drawing);
    } else {
        fmt::print("Case {} in {}: skin at {:.0f}, {} triangles, LUT {} x {} x {} voxels of {:.2f} mm, {} plan items.\n",
                   the_case.code, options.out.string(), done.threshold, the_case.skin.triangles.size(), the_case.lut.size[0],
                   the_case.lut.size[1], the_case.lut.size[2], the_case.lut.voxel_mm, the_case.plan.size());
        fmt::print("Report: {}\n", (options.out / "report.html").string());
    }
    if (options.preview) show_case(the_case, drawing);
    return 0;
}

}  // namespace planlight
