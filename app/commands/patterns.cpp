#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "app/commands/capture_conversion.h"
#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/console.h"
#include "app/json_text.h"
#include "planning_io/files/image_file.h"
#include "planning_io/files/make_folder.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "registration/scan/pattern/stripe_patterns.h"

namespace planlight {
namespace {

struct PatternsOptions {
    Path out;
    int width = 1920, height = 1080, phase_steps = 8;
    double phase_period_px = 16;
    std::string set = "full";   ///< or "fast", "multi-frequency"
    bool columns_only = false;  ///< no rows
    bool json = false;
};

/// Refused where two options contradict each other: the pictures would not be those that were asked for.
StripeSettings stripes_of(const PatternsOptions& options) {
    const auto refuse = [&](const std::string& what, const std::string& remedy) {
        throw Error(ExitCode::usage, fmt::format("the set \"{}\" has its own {}", options.set, what), remedy);
    };
    const StripeSettings usual;
    StripeSettings stripes;
    if (options.set == "fast") {
        if (options.phase_steps != usual.phase_steps) refuse("number of shifts (5)", "Leave --phase-steps out.");
        stripes = fast_stripes(options.width, options.height);
        stripes.phase_period_px = options.phase_period_px;
    } else if (options.set == "multi-frequency") {
        if (options.phase_steps != usual.phase_steps) refuse("numbers of shifts (8 and 5)", "Leave --phase-steps out.");
        if (options.phase_period_px != usual.phase_period_px) refuse("periods", "Leave --phase-period-px out.");
        stripes = multi_frequency_stripes(options.width, options.height, !options.columns_only);
    } else {
        stripes.width = options.width;
        stripes.height = options.height;
        stripes.phase_steps = options.phase_steps;
        stripes.phase_period_px = options.phase_period_px;
        stripes.rows = !options.columns_only;
    }
    return stripes;
}

std::vector<StripePattern> sequence_of(const StripeSettings& stripes) {
    try {
        return stripe_sequence(stripes);
    } catch (const std::invalid_argument& error) {
        throw InputError({}, fmt::format("{} x {} pixels: {}", stripes.width, stripes.height, error.what()),
                         "Take another set, or a longer period.");
    }
}

int run_patterns(const PatternsOptions& options) {
    const StripeSettings stripes = stripes_of(options);
    const auto sequence = sequence_of(stripes);
    ScanCapture capture;
    capture.stripes = stripes;
    const CaptureFolder settings = capture_folder_from(capture);
    nlohmann::json result = {{"projector_width", stripes.width},
                             {"projector_height", stripes.height},
                             {"phase_steps", stripes.phase_steps},
                             {"phase_period_px", stripes.phase_period_px},
                             {"rows", stripes.rows},
                             {"inverse", stripes.inverse},
                             {"patterns", settings.names}};
    if (!stripes.order_periods_px.empty()) {
        result["order_periods_px"] = stripes.order_periods_px;
        result["order_steps"] = stripes.order_steps;
    }
    if (options.out.has_parent_path()) make_folder(options.out.parent_path());
    ProgressBar bar;
    write_folder_safely(options.out, false, [&](const Path& into) {
        for (std::size_t i = 0; i < sequence.size(); ++i) {
            write_png(draw_stripes(stripes, sequence[i]), into / (sequence[i].name + ".png"));
            bar.show("patterns", static_cast<double>(i + 1) / static_cast<double>(sequence.size()));
        }
        write_capture_settings(settings, into / "capture.json");
        write_safely(into / "patterns.json", json_text(result) + "\n");
    });
    if (options.json)
        std::cout << json_text(result) << '\n';
    else
        fmt::print(
            "{} patterns of {} x {} pixels in {}, in the order of patterns.json; capture.json is for beside the "
            "captures of "
            "them.\n",
            sequence.size(), stripes.width, stripes.height, options.out.string());
    return 0;
}

}  // namespace

Run add_patterns(CLI::App& app) {
    const auto options = std::make_shared<PatternsOptions>();
    PatternsOptions& o = *options;
    auto* sub = add_command(app, "patterns", "Write the coded-light sequence as pictures to project",
                            "patterns --width 1920 --height 1080 --out patterns");
    sub->add_option("--width", o.width, "Of the projector, pixels")->capture_default_str()->check(CLI::Range(64, 8192));
    sub->add_option("--height", o.height, "Of the projector, pixels")
        ->capture_default_str()
        ->check(CLI::Range(64, 8192));
    sub->add_option("--phase-steps", o.phase_steps, "Shifts a direction")
        ->capture_default_str()
        ->check(CLI::Range(3, 32));
    sub->add_option(
           "--set", o.set,
           "full: columns and rows, each bit with its inverse; fast: a third of the pictures, columns only, 5 shifts; "
           "multi-frequency: fringes of three or four periods instead of the Gray code")
        ->capture_default_str()
        ->check(CLI::IsMember({"full", "fast", "multi-frequency"}));
    sub->add_flag("--columns-only", o.columns_only,
                  "Half the pictures (not with the set fast, which has no rows); points then need both cameras");
    sub->add_option("--phase-period-px", o.phase_period_px, "Projector pixels a fringe")
        ->capture_default_str()
        ->check(CLI::Range(4.0, 256.0));
    sub->add_option("--out", o.out, "Folder to write")->required();
    json_flag(sub, o.json);
    return [options] { return run_patterns(*options); };
}

}  // namespace planlight
