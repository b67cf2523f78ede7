#include "tests/app/run_command.h"

#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

namespace planlight::test {
namespace {

std::string content_of(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

}  // namespace

CommandRun run_planlight(const std::string& arguments, const std::filesystem::path& folder) {
    const auto out = folder / ".stdout", err = folder / ".stderr";
    const std::string line = "cd '" + folder.string() + "' && '" PLANLIGHT_PROGRAM "' " + arguments + " >'" +
                             out.string() + "' 2>'" + err.string() + "' </dev/null";
    const int status = std::system(line.c_str());
    CommandRun run;
    run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    run.out = content_of(out);
    run.err = content_of(err);
    std::filesystem::remove(out);
    std::filesystem::remove(err);
    return run;
}

}  // namespace planlight::test
