#pragma once
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "planning_io/types/error.h"
#include "registration/simulation/serve/served_room.h"
#include "tests/support/test_data.h"

/// What the programs that operate in the served room have in common: they need the example patient, a second loopback
/// address for the second camera, and a machine that serves in time.
namespace planlight::test {

constexpr int kSkipped = 77;  ///< the exit code by which CTest knows a test that could not be run here

/// Two cameras with clocks of their own: hours apart, drifting by 100 and -50 ppm.
inline simulation::ServeSettings cameras_with_their_own_clocks() {
    simulation::ServeSettings serve;
    serve.left.serial = "SIM-L";
    serve.right.serial = "SIM-R";
    serve.right.address = "127.0.0.2";
    serve.left.clock_offset = std::chrono::hours(17);
    serve.left.clock_drift = 100e-6;
    serve.right.clock_drift = -50e-6;
    return serve;
}

/// Whether more than a tenth of the cameras' pictures were late: then a failure says nothing about the program.
inline bool too_busy_to_serve(const simulation::ServedRoom& served) {
    if (10 * served.late() <= served.made()) return false;
    fmt::print("skipped: this machine is too busy to serve the room in time\n");
    return true;
}

/// Runs `run(program)`, with $PLANLIGHT the program, and gives the exit code of the test.
template <typename RunInServedRoom>
int main_in_served_room(RunInServedRoom&& run) {
    const char* program = std::getenv("PLANLIGHT");
    if (!program) return 2;
    if (!example_patient()) {
        fmt::print("skipped: the example patient is not installed\n");
        return kSkipped;
    }
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    [[maybe_unused]] const int added = std::system("ip address add 127.0.0.2/8 dev lo 2>/dev/null");
    try {
        return run(std::string(program));
    } catch (const Error& error) {
        fmt::print("FAIL {} {}\n", error.what(), error.remedy);
        return 1;
    }
}

}  // namespace planlight::test
