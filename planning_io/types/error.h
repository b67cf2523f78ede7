#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace planlight {

/// Exit codes of every command (the same table stands in the README).
enum class ExitCode {
    done = 0,
    usage = 2,
    input_refused = 3,
    file_damaged = 4,  ///< damaged, or of another version
    device = 5,
    check_failed = 6,
    disk = 7,
    our_fault = 70,
};

/// What a person needs to hear: what happened, and what to do about it. Becomes one sentence and an exit code in main.
class Error : public std::runtime_error {
public:
    Error(ExitCode code, const std::string& problem, std::string what_to_do)
        : std::runtime_error(problem), exit_code(code), remedy(std::move(what_to_do)) {}
    ExitCode exit_code;
    std::string remedy;  ///< one sentence in the imperative; never empty
};

/// An input that is understood and refused (exit 3): wrong frame, implausible plan, missing slice.
class InputError : public Error {
public:
    InputError(const std::filesystem::path& file, const std::string& problem, std::string what_to_do)
        : Error(ExitCode::input_refused, file.empty() ? problem : file.string() + ": " + problem,
                std::move(what_to_do)) {}
};

/// A file that is damaged, truncated, or of another version (exit 4).
class DamagedFileError : public Error {
public:
    DamagedFileError(const std::filesystem::path& file, const std::string& problem, std::string what_to_do)
        : Error(ExitCode::file_damaged, file.string() + ": " + problem, std::move(what_to_do)) {}
};

/// A camera, projector or monitor that does not do what it promised (exit 5).
class DeviceError : public Error {
public:
    DeviceError(const std::string& device, const std::string& problem, std::string what_to_do)
        : Error(ExitCode::device, device + ": " + problem, std::move(what_to_do)) {}
};

/// A result that exists and is not good enough to be used (exit 6): a registration that is refused, a check that
/// failed.
class CheckFailedError : public Error {
public:
    CheckFailedError(const std::string& problem, std::string what_to_do)
        : Error(ExitCode::check_failed, problem, std::move(what_to_do)) {}
};

/// A write that the disk refused (exit 7). The file that was there before is still there.
class DiskError : public Error {
public:
    DiskError(const std::filesystem::path& file, const std::string& problem, std::string what_to_do)
        : Error(ExitCode::disk, file.string() + ": " + problem, std::move(what_to_do)) {}
};

}  // namespace planlight
