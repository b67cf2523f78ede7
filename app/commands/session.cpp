#include "app/commands/commands.h"
#include "app/live/live_window.h"
#include "planning_io/case_folder.h"
#include "planning_io/read_volume.h"
#include "planning_io/types/error.h"

namespace planlight {

int run_session(const SessionOptions& options) {
    const Case the_case = read_case(options.case_folder);
    const Volume volume = read_volume(options.volume);
    if (hash_of(volume) != the_case.volume_hash)
        throw InputError(options.volume, "this is not the volume that the case was made from",
                         "Give the volume of this case, or prepare a case from this volume.");
    LiveOptions live;
    live.preset = options.preset == "paper" ? simulation::Preset::paper : simulation::Preset::modern;
    live.seed = options.seed;
    live.speed_mm_s = options.speed_mm_s;
    live.projector_monitor = options.projector_monitor;
    live.operator_monitor = options.operator_monitor;
    if (!options.projector_file.empty()) live.projector = read_projector_file(options.projector_file);
    if (options.light_delay_ms >= 0) live.projector.light_delay = from_seconds(options.light_delay_ms / 1e3);
    live.autoplay = options.autoplay;
    live.end_after_s = options.end_after_s;
    live.screenshots = options.screenshots;
    live.keep_matches_in = options.keep.empty() ? options.case_folder / kRegistrationsFolder : options.keep;
    return run_live(volume, the_case, CaseDrawing(the_case), live);
}

}  // namespace planlight
