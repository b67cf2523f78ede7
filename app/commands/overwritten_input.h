#pragma once

#include <string>

namespace CLI {
class App;
}

namespace planlight {

/// Which file a command would write over what it reads, or twice, in a sentence with its remedy; empty: none. Asked of
/// a command whose line was parsed, before it runs: a name completed by the shell is easily the wrong one, and a
/// calibration that a cloud was written over is lost.
std::string overwritten_input(const CLI::App& command);

}  // namespace planlight
