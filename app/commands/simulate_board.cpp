#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands/capture_conversion.h"
#include "app/commands/simulate_options.h"
#include "app/console.h"
#include "app/json_text.h"
#include "planning_io/files/make_folder.h"
#include "planning_io/files/safe_write.h"
#include "registration/calibration/draw_board.h"
#include "registration/simulation/board_room.h"

namespace planlight {

namespace {

simulation::BoardSheet printed(const BoardSpec& board) {
    constexpr int kPxPerSquare = 256;
    simulation::BoardSheet sheet;
    sheet.print = draw_board(board, kPxPerSquare);
    sheet.px_per_mm = kPxPerSquare / board.square_mm;
    return sheet;
}

}  // namespace

int run_simulate_board(const SimulateOptions& options) {
    const BoardSpec board = parse_board(options.board);
    simulation::BoardRoomSettings settings;
    settings.preset = options.preset == "paper" ? simulation::Preset::paper : simulation::Preset::modern;
    settings.seed = options.seed;
    settings.poses = options.poses;
    settings.projector_delay = from_seconds(options.projector_delay_ms / 1e3);
    settings.whole = board.kind == BoardSpec::Kind::chessboard;
    settings.light.whole_exposure = !options.serve.empty();  // as real cameras see it
    simulation::SimulatedBoardRoom room(printed(board), settings);
    if (!options.serve.empty()) return run_simulate_served_board(options, room);
    StripeSettings stripes;
    stripes.width = room.projector().width();
    stripes.height = room.projector().height();
    ProgressBar bar;
    for (int pose = 0; pose < room.poses(); ++pose) {
        room.lay(pose);
        const ScanCapture capture = capture_scan(
            room.projector(), room.cameras(), room.clock(), stripes,
            [&](int done, int of) { bar.show("poses", (pose + static_cast<double>(done) / of) / room.poses()); });
        make_folder(options.out / "captures");
        write_capture(capture_folder_from(capture), options.out / "captures" / fmt::format("pose-{:02}", pose));
    }
    write_safely(options.out / "truth.json", room.truth_json() + "\n");
    const nlohmann::json result = {{"folder", options.out.string()},
                                   {"preset", options.preset},
                                   {"seed", options.seed},
                                   {"board", text_of(board)},
                                   {"poses", room.poses()}};
    if (options.json)
        std::cout << json_text(result) << '\n';
    else
        fmt::print("{}: captures of {} poses of a {}, truth.json.\n", options.out.string(), room.poses(),
                   text_of(board));
    return 0;
}

}  // namespace planlight
