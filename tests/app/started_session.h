#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace planlight::test {

/// An X server without a monitor (Xvfb), for windows that nobody looks at.
class BlindDisplay {
public:
    /// Empty where Xvfb is not installed or does not start.
    static std::unique_ptr<BlindDisplay> start();
    ~BlindDisplay();
    BlindDisplay(const BlindDisplay&) = delete;
    BlindDisplay& operator=(const BlindDisplay&) = delete;
    const std::string& name() const { return name_; }  ///< ":7"

private:
    BlindDisplay(pid_t process, std::string name) : process_(process), name_(std::move(name)) {}
    pid_t process_;
    std::string name_;
};

/// `planlight ARGUMENTS` on such a display, running beside the test.
class StartedProgram {
public:
    /// What it says goes into FOLDER/said.
    StartedProgram(const BlindDisplay& display, const std::vector<std::string>& arguments,
                   const std::filesystem::path& folder);
    ~StartedProgram();  ///< killed, if it still runs
    StartedProgram(const StartedProgram&) = delete;
    StartedProgram& operator=(const StartedProgram&) = delete;

    void kill() const;  ///< SIGKILL
    /// Its exit code, 128 + signal when it was killed; -1: it still runs after so long.
    int wait(std::chrono::seconds longest);
    std::string said() const;

private:
    pid_t process_ = -1;
    int ended_ = -1;
    std::filesystem::path log_;
};

}  // namespace planlight::test
