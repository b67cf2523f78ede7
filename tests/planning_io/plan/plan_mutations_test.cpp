#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <random>

#include "planning_io/files/safe_write.h"
#include "planning_io/plan/plan_file.h"
#include "planning_io/plan/plan_import.h"
#include "planning_io/plan/plan_rtstruct.h"
#include "planning_io/plan/plan_shapes.h"
#include "planning_io/surface/surface_file.h"
#include "planning_io/types/error.h"
#include "tests/planning_io/plan_facts.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

/// A few bytes flipped, doubled, cut out, overwritten by words that parsers stumble over, or the end cut off.
std::string mutated(std::string content, std::mt19937& random) {
    static const char* const kWords[] = {"nan", "inf", "-1", "1e308",    "99999999999999999999", "\"",  ",",   "\n",
                                         "{",   "[",   "]",  "\0\0\0\0", "\xFF\xFF\xFF\xFF",     "LPS", "RAS", "<",
                                         "0"};
    const auto below = [&](std::size_t n) {
        return n == 0 ? 0 : std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
    };
    for (std::size_t times = 1 + below(4); times > 0 && !content.empty(); --times) {
        const std::size_t at = below(content.size()), length = std::min(content.size() - at, 1 + below(16));
        switch (below(5)) {
            case 0:
                content[at] = static_cast<char>(content[at] ^ (1 << below(8)));
                break;
            case 1:
                content.erase(at, length);
                break;
            case 2:
                content.insert(at, content.substr(at, length));
                break;
            case 3:
                content.replace(at, length, kWords[below(std::size(kWords))]);
                break;
            default:
                if (below(8) == 0) content.resize(at);
        }
    }
    return content;
}

/// Reads mutated copies of a file: whatever is thrown must be an Error with a remedy, and nothing may take 2 s.
class Mutations {
public:
    explicit Mutations(const fs::path& folder) : folder_(folder) {}

    void read(const std::string& seed_name, const std::string& seed, int count, const PlanImportSettings& settings) {
        int read = 0, refused = 0, damaged = 0;
        double slowest_s = 0;
        for (int i = 0; i < count; ++i) {
            const fs::path file = folder_ / seed_name;
            std::ofstream(file, std::ios::binary) << mutated(seed, random_);
            const auto began = std::chrono::steady_clock::now();
            try {
                const PlanImport plan = import_plan(file, settings);
                EXPECT_NO_THROW(check_plan_numbers(plan.plan, file));  // what is read is finite
                ++read;
            } catch (const Error& e) {
                ++(e.exit_code == ExitCode::file_damaged ? damaged : refused);
                EXPECT_FALSE(e.remedy.empty());
                EXPECT_TRUE(e.exit_code == ExitCode::file_damaged || e.exit_code == ExitCode::input_refused)
                    << e.what();
            } catch (const std::exception& e) {
                ADD_FAILURE() << seed_name << " mutation " << i << ": " << e.what();
                fs::copy_file(file, fs::temp_directory_path() / ("mutation-" + seed_name),
                              fs::copy_options::overwrite_existing);
            }
            slowest_s =
                std::max(slowest_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
        }
        std::printf("%s: %d read, %d refused, %d damaged, slowest %.3f s\n", seed_name.c_str(), read, refused, damaged,
                    slowest_s);
        EXPECT_LT(slowest_s, 2);
        EXPECT_GT(refused + damaged, 0);
    }

private:
    fs::path folder_;
    std::mt19937 random_{11};
};

TEST(PlanMutations, NoMutatedFileBringsTheProgramDown) {
    const test::TemporaryFolder folder;
    const fs::path data = fs::path(PLANLIGHT_SOURCE_DIR) / "tests" / "data" / "plans";
    const char* more = std::getenv("PLANLIGHT_MUTATIONS");  // how many times as many
    const int times = more ? std::max(1, std::atoi(more)) : 1;
    const Plan plan = test::random_plan(4);
    PlanImportSettings same_ct, lps;
    same_ct.frame_of_reference_uid = "1.2.3";
    lps.space = Space::lps;
    write_plan(plan, folder.path() / "seed.mrk.json");
    write_plan_vtp(plan, folder.path() / "seed.vtp");
    write_plan_rtstruct(plan, {"code", "1.2.3", "2026-01-01T00:00:00Z"}, folder.path() / "seed.dcm");
    Mutations mutations(folder.path());
    mutations.read("a.mrk.json", read_whole(folder.path() / "seed.mrk.json"), 300 * times, {});
    mutations.read("a.fcsv", read_whole(data / "slicer_4.4.fcsv"), 500 * times, {});
    mutations.read("b.fcsv", read_whole(data / "slicer_3.fcsv"), 300 * times, {});
    mutations.read("a.csv", read_whole(data / "seeg_trajectories.csv"), 500 * times, lps);
    mutations.read("a.obj", "# SPACE=RAS\nv 1 2 3\nv 10 2 3\nv 10 20 3\nv 1 20 3\nl 1 2 3\nf 1 2 3 4\n", 500 * times,
                   {});
    std::string stl = "solid SPACE=LPS\n";
    for (int i = 0; i < 2; ++i)
        stl += "facet normal 0 0 1\nouter loop\nvertex " + std::to_string(50 * i) +
               " 0 0\nvertex 20 0 0\nvertex 0 20 0\nendloop\nendfacet\n";
    mutations.read("a.stl", stl + "endsolid\n", 300 * times, {});
    mutations.read(
        "a.ply",
        "ply\nformat ascii 1.0\ncomment SPACE=LPS\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
        "float z\nelement face 2\n"
        "property list uchar int vertex_indices\nend_header\n0 0 0\n20 0 0\n20 20 0\n0 20 0\n3 0 1 2\n3 0 2 3\n",
        300 * times, {});
    mutations.read("a.vtp", read_whole(folder.path() / "seed.vtp"), 150 * times, {});
    mutations.read(
        "a.vtk",
        "# vtk DataFile Version 3.0\nSPACE=LPS\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 10 0 0 10 10 0 10 10 "
        "10\nLINES 3 9\n2 0 1\n2 1 2\n2 2 3\n",
        150 * times, {});
    mutations.read("a.dcm", read_whole(folder.path() / "seed.dcm"), 150 * times, same_ct);
}

}  // namespace
}  // namespace planlight
