#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands/capture_conversion.h"
#include "app/commands/commands.h"
#include "planning_io/mesh_file.h"
#include "planning_io/rig_file.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

nlohmann::json counts(const DecodedView& view) {
    return {{"decoded", view.decoded}, {"dark", view.dark}, {"saturated", view.saturated}, {"uncertain", view.uncertain}};
}

}  // namespace

int run_scan(const ScanOptions& options) {
    const RigCalibration rig = read_rig(options.rig);
    const ScanCapture capture = scan_capture_from(read_capture(options.capture), options.capture);
    check_sizes(capture, rig, options.capture);
    const ScanResult scan = scan_from_capture(capture, rig);
    if (scan.clean.kept.empty())
        throw CheckFailedError(fmt::format("no skin was found in the capture ({} of {} pixels of the left picture decoded)",
                                           scan.left.decoded, scan.left.width * scan.left.height),
                               "Check that the projector lights the patient and that rig.json belongs to this capture.");
    write_cloud(scan.clean.kept, options.out);
    if (!options.raw_out.empty()) write_cloud(scan.raw.cloud, options.raw_out);
    if (options.json) {
        const nlohmann::json result = {
            {"points", scan.clean.kept.size()},
            {"raw_points", scan.raw.cloud.size()},
            {"left", counts(scan.left)},
            {"right", counts(scan.right)},
            {"three_view", scan.raw.three_view},
            {"two_view", scan.raw.two_view},
            {"removed", {{"no_partner", scan.raw.no_partner}, {"disagree", scan.raw.disagree},
                         {"outside_volume", scan.raw.outside_volume}, {"jump", scan.clean.jump},
                         {"grazing", scan.clean.grazing}, {"small_piece", scan.clean.small_piece},
                         {"lonely", scan.clean.lonely}, {"thinned", scan.clean.thinned}}},
            {"seconds", {{"decode", scan.decode_s}, {"triangulate", scan.triangulate_s}, {"outliers", scan.outliers_s}}}};
        std::cout << result.dump(2) << '\n';
    } else {
        fmt::print("{} points in {} (raw {}; off the rays {}, jumps {}, grazing {}, small pieces {}, lonely {}).\n",
                   scan.clean.kept.size(), options.out.string(), scan.raw.cloud.size(), scan.raw.disagree, scan.clean.jump,
                   scan.clean.grazing, scan.clean.small_piece, scan.clean.lonely);
    }
    return 0;
}

}  // namespace planlight
