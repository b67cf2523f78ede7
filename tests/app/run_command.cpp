#include "tests/app/run_command.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

namespace planlight::test {
std::string whole(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

void expect_refused(const CommandRun& run, int exit_code, const std::string& about) {
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    EXPECT_NE(run.err.find(about), std::string::npos) << run.err;
}

CommandRun run_planlight(const std::string& arguments, const std::filesystem::path& folder, const std::string& before) {
    const auto out = folder / ".stdout", err = folder / ".stderr";
    const std::string line = "cd '" + folder.string() + "' && " + before + "'" PLANLIGHT_PROGRAM "' " + arguments +
                             " >'" + out.string() + "' 2>'" + err.string() + "' </dev/null";
    const int status = std::system(line.c_str());
    CommandRun run;
    run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    run.out = whole(out);
    run.err = whole(err);
    std::filesystem::remove(out);
    std::filesystem::remove(err);
    return run;
}

}  // namespace planlight::test
