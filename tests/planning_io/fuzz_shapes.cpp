#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/planning_io/mutate_shapes.h"

/// fuzz_shapes [--files N] [--seed S] [--keep FOLDER]: prints what the readers of meshes, lines and clouds made of N
/// damaged files; exit 1 for any fault of ours. To be built with AddressSanitizer (preset `asan`), which ends it at the
/// first step out of bounds; FOLDER/last.* is then the file.
int main(int argc, char** argv) {
    int files = 1000;
    unsigned seed = 1;
    std::filesystem::path keep;
    for (int i = 1; i + 1 < argc; i += 2) {
        const std::string option = argv[i];
        if (option == "--files") files = std::atoi(argv[i + 1]);
        if (option == "--seed") seed = static_cast<unsigned>(std::atoi(argv[i + 1]));
        if (option == "--keep") keep = argv[i + 1];
    }
    if (!keep.empty()) std::filesystem::create_directories(keep);
    const auto c = planlight::test::mutate_shapes(files, seed, keep);
    fmt::print("{} files, {} readings: read {}, refused {}, damaged {} (of these VTK crashed in its child {})\n",
               c.files, c.readings, c.read, c.refused, c.damaged, c.child_crashes);
    for (const auto& [reader, count] : c.read_by_format) fmt::print("  read by {}: {}\n", reader, count);
    fmt::print("faults of ours {}, slowest reading {:.3f} s of processor\n", c.not_an_error, c.slowest_s);
    for (const auto& fault : c.faults) fmt::print("  {}\n", fault);
    return c.not_an_error ? 1 : 0;
}
