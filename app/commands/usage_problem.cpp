#include "app/commands/usage_problem.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>

#include "planning_io/files/nearest_word.h"

namespace planlight {
namespace {

bool is_option(const std::string& word) {
    return word.size() > 1 && word.front() == '-';
}

std::vector<std::string> options_of(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
        for (const std::string& name : option->get_snames()) names.push_back("-" + name);
    }
    return names;
}

std::vector<std::string> commands_of(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({}))
        if (!command->get_group().empty()) names.push_back(command->get_name());  // else not for people
    return names;
}

std::string meant(const std::optional<std::string>& nearest) {
    return nearest ? fmt::format(" Is {} meant?", *nearest) : std::string();
}

/// The first word that nobody knows what to do with; empty: all were known.
std::string unknown_word(const CLI::App& app, const CLI::App* command) {
    for (const std::string& word : command ? command->remaining() : app.remaining(true)) {
        const std::string name = word.substr(0, word.find('='));
        if (is_option(name))
            return fmt::format("\"{}\" is no option{}.", name, command ? " of this command" : "") +
                   meant(nearest_word(name, options_of(command ? *command : app)));
        if (command) return fmt::format("\"{}\" is one argument too many.", word);
        const auto commands = commands_of(app);
        const auto nearest = nearest_word(word, commands);
        return fmt::format("\"{}\" is no command.{}", word,
                           nearest ? meant(nearest) : fmt::format(" The commands are: {}.", fmt::join(commands, ", ")));
    }
    return {};
}

/// The library's sentence with a full stop.
std::string sentence(std::string text) {
    if (const auto line = text.find('\n'); line != std::string::npos) text.resize(line);
    if (!text.empty() && text.back() != '.') text += '.';
    return text;
}

}  // namespace

std::string usage_problem(const CLI::App& app, const CLI::ParseError& error) {
    const auto parsed = app.get_subcommands();
    const CLI::App* command = parsed.empty() ? nullptr : parsed.front();
    std::string problem = unknown_word(app, command);
    if (problem.empty() && !command) problem = "No command is given.";
    if (problem.empty()) problem = sentence(error.what());
    const std::string name = command ? "planlight " + command->get_name() : "planlight";
    return fmt::format("{}: {} Run `{} --help`.", name, problem, name);
}

}  // namespace planlight
