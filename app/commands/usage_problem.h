#pragma once

#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace planlight {

/// What is wrong with a command line that could not be parsed, in a sentence or two for stderr: an unknown command or
/// option with the one that was probably meant, and the command whose --help tells the rest.
std::string usage_problem(const CLI::App& app, const CLI::ParseError& error);

}  // namespace planlight
