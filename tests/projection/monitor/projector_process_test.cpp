#include "projection/monitor/projector_process.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "planning_io/types/error.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

/// Says that it is ready, and no more.
std::filesystem::path stand_in(const std::filesystem::path& folder) {
    const std::filesystem::path script = folder / "stand_in";
    std::ofstream(script) << "#!/bin/sh\n"
                          << "printf '\\001' | dd of=/proc/self/fd/" << kProjectorMailbox
                          << " bs=1 conv=notrunc 2>/dev/null\n"
                          << "exec sleep 1000\n";
    std::filesystem::permissions(script, std::filesystem::perms::owner_all);
    return script;
}

// Ctrl-Z stops all processes of the job: the program, which then renews no lease, and a projector process of the same
// job, which then has nobody that makes it dark.
TEST(ProjectorProcess, IsNotOfTheJobThatATerminalStops) {
    const test::TemporaryFolder folder;
    ProjectorProcessSettings settings;
    settings.program = stand_in(folder.path());
    const ProjectorProcess projector("any", settings);
    EXPECT_EQ(getpgid(projector.process()), projector.process());
    EXPECT_NE(getpgid(projector.process()), getpgrp());
}

// Whoever waits for a device to come back (a guided calibration) must know it for one.
TEST(ProjectorProcess, ThatDoesNotAnswerIsADeviceThatIsLost) {
    const test::TemporaryFolder folder;
    ProjectorProcessSettings settings;
    settings.program = stand_in(folder.path());
    ProjectorProcess projector("any", settings);
    try {
        projector.check();  // the stand-in has never said that it is alive
        FAIL() << "it is taken for alive";
    } catch (const DeviceError& error) {
        EXPECT_STREQ(error.what(), "Projector process: it does not answer any more");
        EXPECT_FALSE(error.remedy.empty());
    }
}

}  // namespace
}  // namespace planlight
