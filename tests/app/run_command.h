#pragma once

#include <filesystem>
#include <string>

namespace planlight::test {

/// What a run of the program gave.
struct CommandRun {
    int exit_code = -1;  ///< 128 + signal when it was killed
    std::string out, err;
};

/// Runs `planlight ARGUMENTS` (shell words) in `folder`, after `before` (shell commands, such as a limit).
CommandRun run_planlight(const std::string& arguments, const std::filesystem::path& folder,
                         const std::string& before = {});

/// The bytes of a file; none when it is not there.
std::string whole(const std::filesystem::path& file);

/// It ended with that code, and the words are in what it said.
void expect_refused(const CommandRun& run, int exit_code, const std::string& about);

}  // namespace planlight::test
