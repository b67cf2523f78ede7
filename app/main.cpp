#include <CLI/CLI.hpp>

#include "app/commands/commands.h"
#include "app/console.h"
#include "planning_io/types/error.h"

namespace {

using namespace planlight;

/// In the order of the help.
constexpr Run (*kCommands[])(CLI::App&) = {
    add_demo,   add_prepare,  add_plan,  add_patterns, add_board,     add_calibrate,        add_check,
    add_scan,   add_register, add_track, add_project,  add_projector, add_projector_window, add_session,
    add_review, add_simulate,
};

constexpr const char* kExitCodes =
    "Exit codes: 0 done, 2 usage, 3 input refused, 4 file damaged or of another version, 5 device, 6 a check failed, 7 "
    "disk,\n"
    "70 a fault of ours.";

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"Planlight shows a surgical plan as light on the patient.\n", "planlight"};
    app.footer(std::string("planlight COMMAND --help shows a command's options and an example.\n") + kExitCodes);
    app.require_subcommand(1);
    app.set_version_flag("--version", "planlight 0.1.0");
    Run chosen;
    for (const auto add : kCommands) {
        Run run = add(app);
        app.get_subcommands({}).back()->callback([&chosen, run = std::move(run)] { chosen = run; });
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::usage);
    }
    return run_and_explain(chosen);
}
