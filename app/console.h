#pragma once

#include <functional>
#include <string>

namespace planlight {

/// A progress bar on stderr, one line per step; silent when stderr is no terminal.
class ProgressBar {
public:
    ProgressBar();
    ~ProgressBar();
    /// Step by name, share 0..1. A new name ends the line of the one before.
    void show(const std::string& step, double share);
    std::function<void(const std::string&, double)> callback();
    /// A line of its own, also where stderr is no terminal.
    void note(const std::string& line);

private:
    void end_line();
    bool terminal_;
    std::string step_;
    int percent_ = -1;
};

/// One line on stderr that begins with "warning: ".
void warn(const std::string& text);

/// The present moment, UTC, ISO 8601.
std::string today();

/// Runs a command: every Error becomes one sentence with its remedy on stderr, and its exit code; memory that is short
/// is exit 7 with what was had; anything else is a fault of ours (70).
int run_and_explain(const std::function<int()>& command);

}  // namespace planlight
