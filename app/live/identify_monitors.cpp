#include "app/live/identify_monitors.h"

#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "app/console.h"
#include "app/json_text.h"
#include "planning_io/types/steady_clock.h"
#include "projection/monitor/monitor_card.h"

namespace planlight {

int identify_monitors(const ProjectorOptions& options) {
    const std::vector<Monitor> monitors = list_monitors();
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < monitors.size(); ++i) {
        const Monitor& m = monitors[i];
        list.push_back(
            {{"number", i},
             {"name", m.name},
             {"width", m.width},
             {"height", m.height},
             {"refresh_hz", m.refresh_hz > 0 ? nlohmann::ordered_json(m.refresh_hz) : nlohmann::ordered_json()},
             {"x", m.x},
             {"y", m.y},
             {"primary", m.primary},
             {"model", m.model},
             {"serial", m.serial}});
        if (!options.json)
            fmt::print("{} {}: {} x {}, {:g} Hz{}{}{}\n", i, m.name, m.width, m.height, m.refresh_hz,
                       m.primary ? ", primary" : "", m.model.empty() ? "" : ", " + m.model,
                       m.serial.empty() ? "" : ", serial " + m.serial);
    }
    if (options.json) std::cout << json_text(list) << '\n';
    std::cout.flush();
    std::fflush(stdout);
    if (options.seconds <= 0) return 0;
    print_to_user(fmt::format(
        "Every monitor shows its name for {:g} s, then goes dark. Nobody may lie under the projector. Ctrl-C "
        "ends it.\n",
        options.seconds));
    note_end_signals();
    const SteadyClock clock;
    for (const std::string& why : show_monitor_cards(clock, options.seconds, [] { return asked_to_end(); })) warn(why);
    return 0;
}

}  // namespace planlight
