// What a fault of the file system ends the program with: 7 for a disk, 3 for a name.
#include <gtest/gtest.h>

#include <cerrno>
#include <filesystem>

#include "app/console.h"

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

}  // namespace
}  // namespace planlight
