#include "app/console.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <new>
#include <system_error>
#include <utility>

#include "app/end_signals.h"
#include "planning_io/files/memory_need.h"
#include "planning_io/files/one_line.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

/// What all of the program writes by.
struct Console {
    ConsoleSettings settings;
    std::FILE* log = nullptr;
    ProgressBar* open_bar = nullptr;  ///< its line on the terminal is not ended
};

Console& console() {
    static Console the_console;
    return the_console;
}

/// Standard output leads nowhere from here on.
void silence_results() {
    std::fflush(stdout);
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nowhere < 0) return;
    ::dup2(nowhere, STDOUT_FILENO);
    ::close(nowhere);
}

void add_to_log(const std::string& line) {
    if (!console().log) return;
    std::fputs(fmt::format("{} {}\n", today(), line).c_str(), console().log);
    std::fflush(console().log);
}

/// A file with something in it that does not begin with a moment as a log does.
bool is_no_log(const std::filesystem::path& file) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error) || std::filesystem::file_size(file, error) == 0) return false;
    std::array<char, 20> begin{};
    std::ifstream(file, std::ios::binary).read(begin.data(), begin.size());
    return begin[4] != '-' || begin[7] != '-' || begin[10] != 'T' || begin[13] != ':' || begin[19] != 'Z';
}

/// Names from outside stand in it: no sign of theirs may steer the terminal. The lines of a table of ours stay lines.
std::string fit_to_print(const std::string& text) {
    std::string fit;
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        fit += (at > 0 ? "\n" : "") + on_one_line(text.substr(at, end - at));
        at = end + 1;
    }
    return fit;
}

}  // namespace

void print_to_user(const std::string& text) {
    std::fputs(text.c_str(), stderr);
}

void set_up_console(const ConsoleSettings& settings, bool result_wanted) {
    console().settings = settings;
    if (!settings.log_file.empty()) {
        if (is_no_log(settings.log_file))
            throw InputError(settings.log_file, "is there already, and is no log of Planlight: nothing is added to it",
                             "Name another file with --log-file.");
        console().log = std::fopen(settings.log_file.c_str(), "ae");
        if (!console().log)
            throw DiskError(settings.log_file, fmt::format("cannot be written ({})", std::strerror(errno)),
                            "Name another file with --log-file.");
    }
    if (settings.quiet && !result_wanted) silence_results();
}

void log_line(const std::string& line) {
    add_to_log(line);
    if (console().settings.verbose) print_to_user(fmt::format("{}\n", line));
}

ProgressBar::ProgressBar() : terminal_(isatty(STDERR_FILENO) == 1 && !console().settings.quiet) {}

ProgressBar::~ProgressBar() {
    end_step();
}

void ProgressBar::show(const std::string& step, double share) {
    const int percent = static_cast<int>(100 * std::clamp(share, 0.0, 1.0));
    if (step != step_) {
        if (percent == 100 && step == done_) return;
        end_step();
        step_ = step;
        began_ = std::chrono::steady_clock::now();
    } else if (percent == percent_) {
        return;
    }
    percent_ = percent;
    if (terminal_) draw(percent);
    if (percent == 100) end_step();
}

void ProgressBar::draw(int percent) {
    constexpr int kWidth = 40;
    const int done = kWidth * percent / 100;
    print_to_user(fmt::format("\r{:<18} [{}{}] {:3d} %", step_, std::string(static_cast<std::size_t>(done), '#'),
                              std::string(static_cast<std::size_t>(kWidth - done), ' '), percent));
    std::fflush(stderr);
    drawn_ = true;
    console().open_bar = this;
}

void ProgressBar::end_step() {
    if (drawn_) print_to_user("\n");
    drawn_ = false;
    if (console().open_bar == this) console().open_bar = nullptr;
    if (!step_.empty())
        log_line(fmt::format("{}: {:.2f} s", step_,
                             std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count()));
    done_ = std::exchange(step_, {});
    percent_ = -1;
}

std::function<void(const std::string&, double)> ProgressBar::callback() {
    return [this](const std::string& step, double share) { show(step, share); };
}

void ProgressBar::note(const std::string& line) {
    end_step();
    const std::string printed = fit_to_print(line);
    add_to_log(printed);
    if (!console().settings.quiet) print_to_user(fmt::format("{}\n", printed));
}

void ProgressBar::warn(const std::string& text) {
    end_step();
    planlight::warn(text);
}

void warn(const std::string& text) {
    if (console().open_bar) print_to_user("\n");
    const std::string printed = fit_to_print(text);
    add_to_log("warning: " + printed);
    print_to_user(fmt::format("warning: {}\n", printed));
}

std::string today() {
    const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
    std::tm utc{};
    gmtime_r(&now, &utc);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    return text;
}

namespace {

/// Names of files stand in it as somebody else gave them.
void say(const std::string& line) {
    const std::string printed = fit_to_print(line);
    add_to_log(printed);
    print_to_user(fmt::format("planlight: {}\n", printed));
}

/// The disk would not take or give it; another name is no help.
bool is_disk_fault(const std::error_code& code) {
    constexpr std::array kOfDisks{EDQUOT, EFBIG, EIO, ENOSPC, EROFS};
    return std::any_of(kOfDisks.begin(), kOfDisks.end(), [&](int one) { return code.value() == one; });
}

int explain_short_memory() {
    say(fmt::format(
        "there is not enough memory: this needs more than the {} MiB that it had. Close other programs, or use "
        "larger voxels.",
        most_memory_used_bytes() >> 20));
    return static_cast<int>(ExitCode::disk);
}

/// Whether all of standard output has arrived: a program that keeps what `--json` prints believes exit 0.
bool printed_whole() {
    std::cout.flush();
    return std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.good();
}

/// Writes its last line and closes the log. Whoever keeps logs learns that this one lacks something.
void end_log(int code) {
    std::FILE* log = std::exchange(console().log, nullptr);
    if (!log) return;
    std::fputs(fmt::format("{} exit {}\n", today(), code).c_str(), log);
    const bool whole = std::fflush(log) == 0 && std::ferror(log) == 0;
    if (std::fclose(log) != 0 || !whole)
        say(fmt::format("the log {} could not be written to its end. Make room on its disk.",
                        console().settings.log_file.string()));
}

}  // namespace

int run_and_explain(const std::function<int()>& command) {
    auto code = static_cast<int>(ExitCode::our_fault);
    try {
        code = command();
    } catch (const Error& error) {
        const std::string_view what = error.what();
        say(fmt::format("{}{} {}", what, what.ends_with('?') || what.ends_with('.') ? "" : ".", error.remedy));
        code = static_cast<int>(error.exit_code);
    } catch (const std::bad_alloc&) {
        code = explain_short_memory();
    } catch (const std::filesystem::filesystem_error& fault) {
        say(fmt::format("{}: {}. Check its name, its permissions and the disk it is on.", fault.path1().string(),
                        fault.code().message()));
        code = static_cast<int>(is_disk_fault(fault.code()) ? ExitCode::disk : ExitCode::input_refused);
    } catch (const std::system_error& fault) {  // a thread that finds no room
        if (fault.code() == std::errc::resource_unavailable_try_again || fault.code() == std::errc::not_enough_memory)
            code = explain_short_memory();
        else
            say(fmt::format("a fault of ours: {}. Please report it with the command that you gave.", fault.what()));
    } catch (const std::exception& fault) {
        say(fmt::format("a fault of ours: {}. Please report it with the command that you gave.", fault.what()));
    }
    if (!printed_whole()) {
        say("what was printed could not be written to its end. Make room where it goes to, and ask again.");
        if (code == 0) code = static_cast<int>(ExitCode::disk);
    }
    end_log(code);
    return code;
}

namespace {
volatile std::sig_atomic_t end_signal = 0;
}

void note_end_signals() {
    struct sigaction action {};
    action.sa_handler = [](int) { end_signal = end_signal + 1; };
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::sigaction(signal, &action, nullptr);
    std::signal(SIGPIPE, SIG_IGN);
}

bool asked_to_end() {
    return end_signal != 0;
}

int times_asked_to_end() {
    return end_signal;
}

}  // namespace planlight
