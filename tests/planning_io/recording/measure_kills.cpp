// measure_kills [COUNT] [SEED]: COUNT (300) programs that record are killed at random instants (SIGKILL); says how many
// of their recordings open and hold all that was written. Exit code 0 when all do.
#include <fmt/format.h>

#include <cstdlib>

#include "tests/planning_io/recording/kill_writer.h"
#include "tests/support/test_data.h"

int main(int argc, char** argv) {
    using namespace planlight::test;
    const int count = argc > 1 ? std::atoi(argv[1]) : 300;
    const TemporaryFolder folder;
    const KilledWriters killed =
        kill_writers(folder.path(), count, argc > 2 ? static_cast<unsigned>(std::atoi(argv[2])) : 1);
    fmt::print(
        "{} of {} recordings open and hold every chunk that was written: {} chunks; {} end within a chunk, which is "
        "left out; at most {} chunks had been handed over and not written.\n{}",
        killed.opened, count, killed.chunks, killed.torn, killed.ahead,
        killed.fault.empty() ? "" : killed.fault + "\n");
    return killed.opened == count ? 0 : 1;
}
