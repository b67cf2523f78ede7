#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands/commands.h"
#include "app/commands/plan_options.h"
#include "app/console.h"
#include "app/prepare_case.h"
#include "planning_io/read_volume.h"

namespace planlight {

int run_prepare(const PrepareOptions& options) {
    ProgressBar bar;
    bar.show("volume", 0);
    const Volume volume = read_volume(options.volume, options.series_uid);
    const PlanImport plan =
        import_plan(options.plan, plan_settings(options.frame, options.accept_frame, volume.frame_of_reference_uid));
    bar.show("volume", 1);
    SkinSettings skin;
    skin.threshold = options.threshold;
    LutSettings lut;
    lut.voxel_mm = options.voxel_mm;
    Preparation done;
    if (options.surface.empty()) {
        done = prepare_case(volume, plan.plan, skin, lut, iso_date_now(), bar.callback());
    } else {
        const SurfaceFile surface = read_surface(
            options.surface,
            {plan_settings(options.surface_frame, options.accept_frame, volume.frame_of_reference_uid), options.segment});
        check_surface_fits(surface.mesh, volume, options.surface);
        done = prepare_case_on(volume, surface, plan.plan, lut, iso_date_now(), bar.callback());
    }
    done.prepared.warnings.insert(done.prepared.warnings.end(), plan.notes.begin(), plan.notes.end());
    bar.show("case folder", 0);
    write_case(done.prepared, options.out, options.replace);
    bar.show("case folder", 1);
    const Case& the_case = done.prepared;
    for (const auto& warning : the_case.warnings) warn(warning);
    if (options.json) {
        const nlohmann::json result = {
            {"case", the_case.code},
            {"folder", options.out.string()},
            {"source", the_case.source},
            {"threshold", done.threshold},
            {"body_ml", done.body_ml},
            {"removed_pieces", done.pieces_removed},
            {"removed_ml", done.removed_ml},
            {"skin", {{"vertices", the_case.skin.vertices_in_ct.size()}, {"triangles", the_case.skin.triangles.size()}}},
            {"lut", {{"size", the_case.lut.size}, {"voxel_mm", the_case.lut.voxel_mm}, {"skin_voxels", the_case.lut.skin.size()}}},
            {"plan_items", the_case.plan.size()},
            {"seconds", {{"skin", done.segment_s}, {"surface", done.triangulate_s}, {"lut", done.lut_s}}},
            {"warnings", the_case.warnings}};
        std::cout << result.dump(2) << '\n';
        return 0;
    }
    fmt::print("Case {} in {}: skin at {:.0f}, {} triangles, LUT {} x {} x {} voxels of {:.2f} mm, {} plan items.\n",
               the_case.code, options.out.string(), done.threshold, the_case.skin.triangles.size(), the_case.lut.size[0],
               the_case.lut.size[1], the_case.lut.size[2], the_case.lut.voxel_mm, the_case.plan.size());
    return 0;
}

}  // namespace planlight
