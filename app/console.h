#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>

namespace planlight {

/// How much is said, and where else (--quiet, --verbose, --log-file of every command).
struct ConsoleSettings {
    bool quiet = false;    ///< only warnings, errors, and what --json prints
    bool verbose = false;  ///< every step on a line of its own with its time, also where stderr is no terminal
    std::filesystem::path log_file;  ///< what happened is added there, a line each with its time; empty: none
};

/// Takes effect for the rest of the program's life. `result_wanted`: what is written to standard output is kept though
/// the console is quiet. Throws DiskError when the log cannot be written.
void set_up_console(const ConsoleSettings& settings, bool result_wanted);

/// A line for the log file and, if `verbose`, for stderr.
void log_line(const std::string& line);

/// A progress bar on stderr, one line per step; silent when stderr is no terminal. A step that is done ends its line,
/// so that what is printed next begins a new one.
class ProgressBar {
public:
    ProgressBar();
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;
    /// Step by name, share 0..1. A new name ends the line of the one before.
    void show(const std::string& step, double share);
    std::function<void(const std::string&, double)> callback();
    /// A line of its own, also where stderr is no terminal.
    void note(const std::string& line);
    /// The same for a warning, which is said under --quiet as well.
    void warn(const std::string& text);

private:
    void draw(int percent);
    void end_step();
    bool terminal_, drawn_ = false;
    std::string step_, done_;  ///< under way; the last that was done
    int percent_ = -1;
    std::chrono::steady_clock::time_point began_;
};

/// One line on stderr that begins with "warning: ".
void warn(const std::string& text);

/// Text on stderr as it is. Whether it arrives is not asked, here and in all others: a terminal that has gone, or a
/// full disk behind it, must not end what runs.
void print_to_user(const std::string& text);

/// From now on SIGINT, SIGTERM and SIGHUP are only noted, so that what runs can end in order, and whoever read what is
/// printed may go (SIGPIPE). A read from the terminal that waits is broken off by them.
void note_end_signals();
/// Whether one of them came since.
bool asked_to_end();

/// The present moment, UTC, ISO 8601.
std::string today();

/// Runs a command: every Error becomes one sentence with its remedy on stderr, and its exit code; memory that is short
/// is exit 7 with what was had; anything else is a fault of ours (70).
int run_and_explain(const std::function<int()>& command);

}  // namespace planlight
