#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands/commands.h"
#include "app/console.h"
#include "planning_io/image_file.h"
#include "planning_io/safe_write.h"
#include "registration/scan/stripe_patterns.h"

namespace planlight {

int run_patterns(const PatternsOptions& options) {
    StripeSettings stripes;
    stripes.width = options.width;
    stripes.height = options.height;
    stripes.phase_steps = options.phase_steps;
    if (options.set == "fast") stripes = fast_stripes(options.width, options.height);
    stripes.phase_period_px = options.phase_period_px;
    if (options.set == "multi-frequency") stripes = multi_frequency_stripes(options.width, options.height, !options.columns_only);
    std::filesystem::create_directories(options.out);
    const auto sequence = stripe_sequence(stripes);
    ProgressBar bar;
    nlohmann::json names = nlohmann::json::array();
    for (std::size_t i = 0; i < sequence.size(); ++i) {
        write_png(draw_stripes(stripes, sequence[i]), options.out / (sequence[i].name + ".png"));
        names.push_back(sequence[i].name);
        bar.show("patterns", static_cast<double>(i + 1) / static_cast<double>(sequence.size()));
    }
    nlohmann::json result = {{"projector_width", stripes.width}, {"projector_height", stripes.height},
                                   {"phase_steps", stripes.phase_steps}, {"phase_period_px", stripes.phase_period_px},
                                   {"rows", stripes.rows}, {"inverse", stripes.inverse}, {"patterns", names}};
    if (!stripes.order_periods_px.empty()) {
        result["order_periods_px"] = stripes.order_periods_px;
        result["order_steps"] = stripes.order_steps;
    }
    write_safely(options.out / "patterns.json", result.dump(2) + "\n");
    if (options.json) std::cout << result.dump(2) << '\n';
    else fmt::print("{} patterns of {} x {} pixels in {}, in the order of patterns.json.\n", sequence.size(), stripes.width,
                    stripes.height, options.out.string());
    return 0;
}

}  // namespace planlight
