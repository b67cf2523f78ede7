#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "app/commands/capture_conversion.h"
#include "app/commands/commands.h"
#include "app/console.h"
#include "planning_io/image_file.h"
#include "planning_io/safe_write.h"
#include "planning_io/types/error.h"
#include "registration/scan/stripe_patterns.h"

namespace planlight {
namespace {

/// Refused where two options contradict each other: the pictures would not be those that were asked for.
StripeSettings stripes_of(const PatternsOptions& options) {
    const auto refuse = [&](const std::string& what, const std::string& remedy) {
        throw InputError({}, fmt::format("the set \"{}\" has its own {}", options.set, what), remedy);
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

}  // namespace

int run_patterns(const PatternsOptions& options) {
    const StripeSettings stripes = stripes_of(options);
    const auto sequence = sequence_of(stripes);
    ScanCapture capture;
    capture.stripes = stripes;
    const CaptureFolder settings = capture_folder_from(capture);
    nlohmann::json result = {{"projector_width", stripes.width}, {"projector_height", stripes.height},
                             {"phase_steps", stripes.phase_steps}, {"phase_period_px", stripes.phase_period_px},
                             {"rows", stripes.rows}, {"inverse", stripes.inverse}, {"patterns", settings.names}};
    if (!stripes.order_periods_px.empty()) {
        result["order_periods_px"] = stripes.order_periods_px;
        result["order_steps"] = stripes.order_steps;
    }
    if (options.out.has_parent_path()) std::filesystem::create_directories(options.out.parent_path());
    ProgressBar bar;
    write_folder_safely(options.out, false, [&](const Path& into) {
        for (std::size_t i = 0; i < sequence.size(); ++i) {
            write_png(draw_stripes(stripes, sequence[i]), into / (sequence[i].name + ".png"));
            bar.show("patterns", static_cast<double>(i + 1) / static_cast<double>(sequence.size()));
        }
        write_capture_settings(settings, into / "capture.json");
        write_safely(into / "patterns.json", result.dump(2) + "\n");
    });
    if (options.json)
        std::cout << result.dump(2) << '\n';
    else
        fmt::print(
            "{} patterns of {} x {} pixels in {}, in the order of patterns.json; capture.json is for beside the captures of "
            "them.\n",
            sequence.size(), stripes.width, stripes.height, options.out.string());
    return 0;
}

}  // namespace planlight
