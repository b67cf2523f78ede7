#include "tests/app/started_session.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <thread>

#include "tests/app/run_command.h"

namespace planlight::test {
namespace {

[[noreturn]] void become(const std::vector<std::string>& words) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    ::execvp(arguments[0], arguments.data());
    ::_exit(127);
}

void send_to(const std::filesystem::path& file) {
    const int out = ::open(file.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
    ::dup2(out, 1);
    ::dup2(out, 2);
}

}  // namespace

std::unique_ptr<BlindDisplay> BlindDisplay::start() {
    std::array<int, 2> number{};
    if (::pipe(number.data()) != 0) return nullptr;
    const pid_t process = ::fork();
    if (process == 0) {
        ::close(number[0]);
        send_to("/dev/null");
        become({"Xvfb", "-displayfd", std::to_string(number[1]), "-screen", "0", "1280x800x24", "-nolisten", "tcp"});
    }
    ::close(number[1]);
    std::string name;
    for (;;) {
        constexpr int kPatience_ms = 30000;
        pollfd waiting{number[0], POLLIN, 0};
        char one = 0;
        if (::poll(&waiting, 1, kPatience_ms) <= 0 || ::read(number[0], &one, 1) <= 0 || one == '\n') break;
        name += one;
    }
    ::close(number[0]);
    std::unique_ptr<BlindDisplay> display(new BlindDisplay(process, ":" + name));
    return name.empty() ? nullptr : std::move(display);
}

BlindDisplay::~BlindDisplay() {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
}

StartedProgram::StartedProgram(const BlindDisplay& display, const std::vector<std::string>& arguments,
                               const std::filesystem::path& folder)
    : log_(folder / "said") {
    std::vector<std::string> words{PLANLIGHT_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    process_ = ::fork();
    if (process_ != 0) return;
    ::setenv("DISPLAY", display.name().c_str(), 1);
    ::setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
    send_to(log_);
    become(words);
}

StartedProgram::~StartedProgram() {
    kill();
    if (ended_ < 0) ::waitpid(process_, nullptr, 0);
}

void StartedProgram::kill() const {
    if (ended_ < 0) ::kill(process_, SIGKILL);
}

int StartedProgram::wait(std::chrono::seconds longest) {
    const auto until = std::chrono::steady_clock::now() + longest;
    for (int status = 0; ended_ < 0 && std::chrono::steady_clock::now() < until;) {
        if (::waitpid(process_, &status, WNOHANG) == process_)
            ended_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
        else
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return ended_;
}

std::string StartedProgram::said() const {
    return whole(log_);
}

}  // namespace planlight::test
