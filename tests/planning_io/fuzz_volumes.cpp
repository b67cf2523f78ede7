#include <fmt/format.h>

#include <cstdlib>
#include <string>

#include "tests/planning_io/mutate_volumes.h"

/// fuzz_volumes [--mutations N] [--seed S]: prints what read_volume made of N damaged volumes; exit 1 for any fault of
/// ours.
int main(int argc, char** argv) {
    int mutations = 500;
    unsigned seed = 1;
    for (int i = 1; i + 1 < argc; i += 2) {
        if (std::string(argv[i]) == "--mutations") mutations = std::atoi(argv[i + 1]);
        if (std::string(argv[i]) == "--seed") seed = static_cast<unsigned>(std::atoi(argv[i + 1]));
    }
    const auto c = planlight::test::mutate_volumes(mutations, seed);
    fmt::print("mutations {}: read {}, refused {}, damaged {}, other {}\n", c.mutations, c.read, c.refused, c.damaged,
               c.other_errors);
    fmt::print("of these the child crashed {}, was cut off by its limits {}\n", c.parser_crashes, c.cut_off);
    fmt::print("faults of ours {}, more than 2 s of processor {}, files changed {}\n", c.not_an_error, c.slow,
               c.changed_files);
    fmt::print("processor {:.1f} s in all, at most {:.2f} s a volume (wall clock at most {:.2f} s)\n", c.processor_s,
               c.most_processor_s, c.most_wall_s);
    for (const auto& [kind, count] : c.crash_kinds) fmt::print("  the child's crash {}: {}\n", kind, count);
    for (const auto& fault : c.faults) fmt::print("  {}\n", fault);
    return c.not_an_error || c.slow || c.changed_files ? 1 : 0;
}
