#include "planning_io/files/memory_need.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

TEST(MemoryNeed, WhatIsNotThereIsRefusedWithTheNeedInMiB) {
    EXPECT_NO_THROW(check_memory("Reading it", 1 << 20, "Close other programs."));
    try {
        check_memory("Reading it", std::uint64_t{1} << 50, "Close other programs.");
        FAIL() << "a pebibyte";
    } catch (const Error& e) {
        EXPECT_EQ(e.exit_code, ExitCode::disk);
        EXPECT_NE(std::string(e.what()).find("needs about 1073741825 MiB"), std::string::npos) << e.what();
    }
}

TEST(MemoryNeed, TheProcesssOwnLimitCounts) {
    const pid_t child = fork();  // a limit cannot be taken back
    if (child == 0) {
        const rlimit limit{std::uint64_t{64} << 30, std::uint64_t{64} << 30};
        setrlimit(RLIMIT_AS, &limit);
        _exit(free_memory_bytes() <= (std::uint64_t{64} << 30) ? 0 : 1);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
    EXPECT_GT(most_memory_used_bytes(), std::uint64_t{1} << 20);
}

}  // namespace
}  // namespace planlight
