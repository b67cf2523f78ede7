// What the program says on the terminal when it ends early, and with which exit code.
#include <gtest/gtest.h>

#include <cerrno>
#include <filesystem>
#include <string>

#include "app/console.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

int exit_code_of(int errno_then) {
    return run_and_explain([&]() -> int {
        throw std::filesystem::filesystem_error("cannot write", "plan.json",
                                                std::error_code(errno_then, std::generic_category()));
    });
}

TEST(ExitCodes, ADiskThatDoesNotTakeOrGiveIsADiskWhateverItSays) {
    for (const int fault : {ENOSPC, EDQUOT, EROFS, EIO, EFBIG}) EXPECT_EQ(exit_code_of(fault), 7) << fault;
}

TEST(ExitCodes, ANameThatCannotBeReadIsRefused) {
    for (const int fault : {ENOENT, EACCES, ENOTDIR, ELOOP}) EXPECT_EQ(exit_code_of(fault), 3) << fault;
}

// A list of series stays a list; a file's name with an escape in it must not colour the terminal, or clear it.
TEST(Console, ATableStaysATableAndNoNameSteersTheTerminal) {
    testing::internal::CaptureStderr();
    run_and_explain([]() -> int {
        throw InputError("evil\x1b[2J.nrrd", "holds two series:\n  1  CT\n  2  MR \u202E", "Choose one with --series.");
    });
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_NE(said.find("holds two series:\n  1  CT\n  2  MR"), std::string::npos) << said;
    EXPECT_EQ(said.find('\x1b'), std::string::npos) << said;
    EXPECT_EQ(said.find("\u202E"), std::string::npos) << said;
}

}  // namespace
}  // namespace planlight
