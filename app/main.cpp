#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>

#include "app/commands/commands.h"
#include "app/commands/overwritten_input.h"
#include "app/commands/usage_problem.h"
#include "app/console.h"
#include "app/freed_memory.h"
#include "app/site_settings.h"
#include "app/words/words.h"
#include "planning_io/types/error.h"
#include "projection/monitor/projector_process.h"

namespace {

using namespace planlight;

/// In the order of the help.
constexpr Run (*kCommands[])(CLI::App&) = {
    add_demo,    add_prepare, add_plan,     add_patterns, add_board,    add_capture,   add_calibrate,
    add_check,   add_scan,    add_register, add_track,    add_project,  add_projector, add_projector_window,
    add_devices, add_cameras, add_doctor,   add_session,  add_review,   add_replay,    add_report,
    add_forget,  add_export,  add_store,    add_fetch,    add_simulate, add_merge,
};

constexpr const char* kExitCodes =
    "Exit codes: 0 done, 2 usage, 3 input refused, 4 file damaged or of another version, 5 device, 6 a check failed,\n"
    "7 disk or too little memory, 70 a fault of ours.";

void console_options(CLI::App* command, ConsoleSettings& console) {
    auto* quiet = command->add_flag("--quiet", console.quiet, "Say warnings and errors only (and what --json prints)");
    command->add_flag("--verbose", console.verbose, "Say every step with the time it took")->excludes(quiet);
    command->add_option("--log-file", console.log_file,
                        "Add what happens to this file, a line each with its time (UTC)");
    for (const char* name : {"--quiet", "--verbose", "--log-file"}) command->get_option(name)->group("What is said");
}

/// What was closed leads nowhere; else the first file that is opened would be written what is meant for a person.
void open_standard_streams() {
    for (int descriptor = 0; descriptor <= STDERR_FILENO; ++descriptor)
        if (::fcntl(descriptor, F_GETFD) < 0 && errno == EBADF) ::open("/dev/null", O_RDWR);
}

/// "nan" is less than nothing and more than nothing: it passes every range.
void refuse_nan(CLI::App& command) {
    const auto is_number = [](const std::string& text) {
        double number = 0;
        return CLI::detail::lexical_cast(text, number) && !std::isfinite(number) ? "not a number: " + text
                                                                                 : std::string();
    };
    for (CLI::Option* option : command.get_options())
        if (option->get_type_name().starts_with("FLOAT")) option->check(CLI::Validator(is_number, ""));
}

/// The first option that was given an empty value, as a shell does of a variable that is not set; empty: none. It would
/// be taken as not given.
std::string given_empty(const CLI::App& command) {
    for (const CLI::Option* option : command.get_options())
        if (!option->get_lnames().empty() && option->get_expected_max() > 0 &&
            std::ranges::any_of(option->results(), &std::string::empty))
            return "--" + option->get_lnames().front();
    return {};
}

int run_command(const CLI::App& command, const Run& run, const ConsoleSettings& console, const std::string& line) {
    if (const std::string option = given_empty(command); !option.empty()) {
        print_to_user(fmt::format("planlight: {} is given, and empty. Give it a value, or leave it out.\n", option));
        return static_cast<int>(ExitCode::usage);
    }
    if (const std::string problem = overwritten_input(command); !problem.empty()) {  // before the log is opened
        print_to_user(fmt::format("planlight: {}\n", problem));
        return static_cast<int>(ExitCode::usage);
    }
    // Also where no window is opened: a typing error would else be met in the operating room.
    if (const auto* language = command.get_option_no_throw("--language"); language && language->count() > 0)
        words_of(language->results().back());
    const auto* json = command.get_option_no_throw("--json");
    set_up_console(console, json && json->count() > 0);
    log_line(fmt::format("planlight {} ({})", PLANLIGHT_VERSION, line));
    if (const SiteSettings site = read_site_settings(); !site.read_from.empty())
        log_line("settings of this site: " + site.read_from.string());
    return run();
}

}  // namespace

int main(int argc, char** argv) {
    open_standard_streams();
    std::signal(SIGXFSZ, SIG_IGN);  // a limit on the size of files is told as a full disk is
    keep_freed_memory();
    CLI::App app{"Planlight shows a surgical plan as light on the patient.\n", "planlight"};
    app.footer(std::string("planlight COMMAND --help shows a command's options and an example.\n") + kExitCodes);
    app.require_subcommand(1);
    app.set_version_flag("--version", "planlight " PLANLIGHT_VERSION);
    ConsoleSettings console;
    std::function<int()> chosen;
    const std::string line = fmt::format("{}", fmt::join(argv + 1, argv + argc, " "));
    for (const auto add : kCommands) {
        Run run = add(app);
        CLI::App* command = app.get_subcommands({}).back();
        refuse_nan(*command);
        console_options(command, console);
        command->callback([&, command, run = std::move(run)] {
            chosen = [&, command, run] { return run_command(*command, run, console, line); };
        });
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return run_and_explain([&] { return app.exit(error); });  // --help, --version
        print_to_user(usage_problem(app, error) + "\n");
        return static_cast<int>(ExitCode::usage);
    }
    const int code = run_and_explain(chosen);
    if (a_projector_process_hangs())
        print_to_user(
            "planlight: the projector's light may still be on: its process hangs. Switch the projector off.\n");
    return code;
}
