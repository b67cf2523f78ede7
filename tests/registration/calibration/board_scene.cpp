#include "tests/registration/calibration/board_scene.h"

#include <fmt/format.h>

#include "registration/calibration/draw_board.h"
#include "registration/scan/scan_surface.h"

namespace planlight::test {

simulation::BoardSheet printed(const BoardSpec& board) {
    constexpr int kPxPerSquare = 256;
    simulation::BoardSheet sheet;
    sheet.print = draw_board(board, kPxPerSquare);
    sheet.px_per_mm = kPxPerSquare / board.square_mm;
    return sheet;
}

StripeSettings stripes_of(const simulation::SimulatedBoardRoom& room) {
    StripeSettings stripes;
    auto& projector = const_cast<simulation::SimulatedBoardRoom&>(room).projector();
    stripes.width = projector.width();
    stripes.height = projector.height();
    return stripes;
}

std::vector<PoseObservation> observe_room(simulation::SimulatedBoardRoom& room, const BoardSpec& board,
                                          const std::function<void(int)>& before,
                                          const std::function<void(int, int)>& during) {
    const StripeSettings stripes = stripes_of(room);
    std::vector<PoseObservation> poses;
    for (int i = 0; i < room.poses(); ++i) {
        room.lay(i);
        if (before) before(i);
        const ScanCapture capture =
            capture_scan(room.projector(), room.cameras(), room.clock(), stripes, [&](int done, int) {
                if (during) during(i, done);
            });
        poses.push_back({fmt::format("pose-{:02}", i), observe_board(capture.left, stripes, board),
                         observe_board(capture.right, stripes, board)});
    }
    return poses;
}

}  // namespace planlight::test
