#include "app/commands/usage_problem.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <regex>
#include <sstream>

#include "planning_io/files/nearest_word.h"
#include "planning_io/types/utf8_prefix.h"

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

/// "a", "a or b", "a, b or c".
std::string alternatives(const std::vector<std::string>& words) {
    if (words.size() < 2) return fmt::format("{}", fmt::join(words, ""));
    return fmt::format("{} or {}", fmt::join(words.begin(), words.end() - 1, ", "), words.back());
}

std::vector<std::string> split_at_commas(const std::string& text) {
    std::vector<std::string> words;
    std::istringstream in(text);
    for (std::string word; std::getline(in, word, ',');) words.push_back(word);
    return words;
}

/// A number without the zeros behind its point: "0.1" of "0.100000".
std::string as_typed(std::string number) {
    if (number.find('.') == std::string::npos) return number;
    while (number.back() == '0') number.pop_back();
    if (number.back() == '.') number.pop_back();
    return number;
}

std::string values(const std::string& count) {
    return count == "1" ? "one value" : count + " values";
}

/// The library's sentence in words that say what to give, with a full stop; as it is where it already does.
std::string sentence(std::string text) {
    if (const auto line = text.find('\n'); line != std::string::npos) text.resize(line);
    constexpr std::size_t kMost = 300;  // a value of a hundred thousand letters is not said whole, nor taken apart
    if (text.size() > kMost) return std::string(utf8_prefix(text, kMost)) + "...";
    std::smatch is;
    if (std::regex_match(text, is, std::regex("Could not convert: (\\S+) = (.*)")))
        return fmt::format("{}: \"{}\" is no number that it takes.", is.str(1), is.str(2));
    if (std::regex_match(text, is, std::regex("(\\S+): (\\d+) required .+ missing")))
        return fmt::format("{} takes {}, and not all were given.", is.str(1), values(is.str(2)));
    if (std::regex_match(text, is, std::regex("(\\S+): At (Most|least) (\\d+) required but received (\\d+)")))
        return fmt::format("{} takes {}{}, and {} were given.", is.str(1), is.str(2) == "least" ? "at least " : "",
                           values(is.str(3)), is.str(4));
    if (std::regex_match(text, is, std::regex("(\\S+): (.*) not in \\{(.*)\\}"))) {
        const auto words = split_at_commas(is.str(3));
        return fmt::format("{}: \"{}\" is not {}.{}", is.str(1), is.str(2), alternatives(words),
                           meant(nearest_word(is.str(2), words)));
    }
    if (std::regex_match(text, is, std::regex("(\\S+): Value (.*) not in range (.*) to (.*)")))
        return fmt::format("{}: \"{}\" is no number from {} to {}.", is.str(1), is.str(2), as_typed(is.str(3)),
                           as_typed(is.str(4)));
    if (std::regex_match(text, is, std::regex("(\\S+) (requires|excludes) (\\S+)")))
        return is.str(2) == "requires" ? fmt::format("{} needs {} beside it.", is.str(1), is.str(3))
                                       : fmt::format("{} and {} cannot be given both.", is.str(1), is.str(3));
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
