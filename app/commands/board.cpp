#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/json_text.h"
#include "planning_io/files/safe_write.h"
#include "registration/calibration/draw_board.h"

namespace planlight {
namespace {

struct BoardOptions {
    std::string board = "charuco 10x7 25 mm";
    Path out = "board";  ///< without ending
    bool json = false;
};

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
        std::cout << json_text(result) << '\n';
    else
        fmt::print(
            "{} and {}: {}, {:.1f} x {:.1f} mm. Print at 100 %, glue it on a flat plate, measure its width and its "
            "height (both must be right), and give the\nmeasured square to `calibrate --board`.\n",
            png.string(), pdf.string(), text_of(board), board.width_mm(), board.height_mm());
    return 0;
}

}  // namespace

Run add_board(CLI::App& app) {
    const auto options = std::make_shared<BoardOptions>();
    BoardOptions& o = *options;
    auto* sub =
        add_command(app, "board", "Draw the calibration board to print (PNG and PDF, true size, grey instead of black)",
                    "board --board \"charuco 10x7 25 mm\" --out board");
    sub->add_option("--board", o.board,
                    "charuco COLUMNSxROWS (squares) or chessboard COLUMNSxROWS (inner corners), and the square in mm")
        ->capture_default_str();
    sub->add_option("--out", o.out, "File to write, without ending")->capture_default_str();
    json_flag(sub, o.json);
    return [options] { return run_board(*options); };
}

}  // namespace planlight
