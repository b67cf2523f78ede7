// Not for people: the projector window in a process of its own (projection/monitor/projector_process.h), started by
// `session`.
#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/freed_memory.h"
#include "projection/monitor/projector_process.h"

namespace planlight {

Run add_projector_window(CLI::App& app) {
    const auto monitor = std::make_shared<std::string>();
    auto* sub = add_command(app, "projector-window", "The projector window of a session (started by it)",
                            "session case --volume Cranium.inv3 --projector HDMI-2");
    sub->group("");  // not in the help
    sub->add_option("--monitor", *monitor, "Monitor to light")->required();
    return [monitor] {
        hand_large_blocks_back();
        return serve_projector(*monitor, kProjectorBell, kProjectorMailbox);
    };
}

}  // namespace planlight
