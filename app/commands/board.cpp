#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands/commands.h"
#include "planning_io/safe_write.h"
#include "registration/calibration/draw_board.h"

namespace planlight {

int run_board(const BoardOptions& options) {
    const BoardSpec board = parse_board(options.board);
    Path png = options.out;
    if (png.extension() == ".pdf" || png.extension() == ".png") png.replace_extension();
    Path pdf = png;
    png += ".png";
    pdf += ".pdf";
    write_safely(png, board_png(board));
    write_safely(pdf, board_pdf(board));
    const nlohmann::json result = {{"board", text_of(board)},      {"corners", board.corner_count()},
                                   {"width_mm", board.width_mm()}, {"height_mm", board.height_mm()},
                                   {"png", png.string()},          {"pdf", pdf.string()}};
    if (options.json)
        std::cout << result.dump(2) << '\n';
    else
        fmt::print(
            "{} and {}: {}, {:.1f} x {:.1f} mm. Print at 100 %, glue it on a flat plate, measure its width, and give the\n"
            "measured square to `calibrate --board`.\n",
            png.string(), pdf.string(), text_of(board), board.width_mm(), board.height_mm());
    return 0;
}

}  // namespace planlight
