#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

// What the commands' options share. Heavy (CLI11): for the commands' .cpp files only.
namespace planlight {

using Path = std::filesystem::path;

/// A command of the program with its help and its example.
CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& what, const std::string& example);

/// --json: the result as JSON on standard output, and nothing else there.
void json_flag(CLI::App* command, bool& json);

/// What a picture's file must be called: only PNG is written.
const CLI::Validator& png_file();

/// --preset: the simulated room.
CLI::Option* preset_option(CLI::App* command, std::string& preset);

/// --series, of a folder that holds several.
void series_option(CLI::App* command, std::string& series_uid);

/// --risk, once for each file of risk structures, and --risk-frame.
void risk_options(CLI::App* command, std::vector<Path>& files, std::string& frame);

/// --frame and --accept-frame, of plan files that do not say their coordinate system.
void plan_frame_options(CLI::App* command, std::string& frame, std::string& accept_frame);

}  // namespace planlight
