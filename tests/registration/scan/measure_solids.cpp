// Scans of solids with seams, folds and thin ridges under light that goes from wall to wall
// (tests/registration/scan/solid_room): measure_solids [DIR] prints, a solid and a set of pictures a line, what the
// clean cloud is off the true surface; with DIR it leaves a camera's white picture and the clouds there.
#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

#include "planning_io/files/image_file.h"
#include "planning_io/surface/mesh_file.h"
#include "planning_io/types/error.h"
#include "tests/registration/scan/solid_room.h"

using namespace planlight;
using namespace planlight::solid_room;

namespace {

struct Set {
    std::string name;
    StripeSettings stripes;
    std::vector<StripePattern> patterns;  ///< empty: the whole sequence
    bool one_camera = false;
};

/// White, black and the bits of a Gray code to single pixels, without the `less` finest.
std::vector<StripePattern> gray_code(bool rows, int less) {
    std::vector<StripePattern> patterns{{StripePattern::Kind::white, false, 0, "white"},
                                        {StripePattern::Kind::black, false, 0, "black"}};
    for (const bool along_rows : {false, true})
        for (const auto& pattern : gray_patterns(10 - less, along_rows, true))
            if (rows || !along_rows) patterns.push_back(pattern);
    return patterns;
}

std::vector<Set> sets_of(const Room& room) {
    StripeSettings full;
    full.width = room.projector.width, full.height = room.projector.height;
    StripeSettings gray = full, columns = full, gray_columns;
    gray.phase_steps = 0, gray.phase_period_px = 2;
    columns.rows = false;
    gray_columns = gray;
    gray_columns.rows = false;
    return {{"full", full, {}},
            {"full, left only", full, {}, true},
            {"columns, left only", columns, {}, true},
            {"Gray code", gray, gray_code(true, 0)},
            {"Gray code, left only", gray, gray_code(true, 0), true},
            {"Gray columns, left only", gray_columns, gray_code(false, 0), true},
            {"Gray code to 8 pixels", gray, gray_code(true, 3)},
            {"Gray code to 8 pixels, left only", gray, gray_code(true, 3), true},
            {"fast", fast_stripes(full.width, full.height), {}},
            {"multi-frequency", multi_frequency_stripes(full.width, full.height), {}}};
}

double share_over(const std::vector<double>& off, double limit) {
    return off.empty() ? 0
                       : static_cast<double>(off.end() - std::lower_bound(off.begin(), off.end(), limit)) /
                             static_cast<double>(off.size());
}

void measure(const std::string& name, const Room& room, const std::filesystem::path& folder) {
    Cameras cameras(room);
    for (const Set& set : sets_of(room)) {
        ScanCapture shot = cameras.capture(set.stripes, set.patterns);
        if (set.one_camera) shot.right.clear();
        if (!folder.empty() && set.name == "full") write_png(shot.left[0], folder / (name + ".png"));
        try {
            const ScanResult scan = scan_from_capture(shot, rig_of(room));
            const auto off = off_the_solid(scan.clean.kept, room.solid);
            const auto at = [&](double share) {
                return off.empty() ? 0 : off[static_cast<std::size_t>(share * static_cast<double>(off.size() - 1))];
            };
            fmt::print("| {} | {} | {} | {:.3f} | {:.2f} | {:.2f} % | {:.2f} % |\n", name, set.name, off.size(),
                       at(0.5), at(0.95), 100 * share_over(off, 1), 100 * share_over(off, 5));
            if (!folder.empty()) write_cloud(scan.clean.kept, folder / (name + ", " + set.name + ".ply"));
        } catch (const Error& refused) {
            fmt::print("| {} | {} | refused: {} |\n", name, set.name, refused.what());
        }
        std::fflush(stdout);
    }
}

}  // namespace

int main(int argc, char** argv) {
    const std::string only = argc > 1 ? argv[1] : "";
    const std::filesystem::path folder = argc > 2 ? argv[2] : "";
    if (!folder.empty()) std::filesystem::create_directories(folder);
    const Vector3d place(15, -10, 600);
    fmt::print(
        "| solid | set | points | median (mm) | 95 % | over 1 mm | over 5 mm |\n|---|---|---|---|---|---|---|\n");
    const Material dull{0.6, 1, 0, 60, 0.8, 0.1}, pale{0.85, 1, 0.25, 40, 1.5, 0.05}, glossy{0.7, 1, 0.6, 60, 1.0, 0.3};
    const Solid behind = wall(place + Vector3d(0, 0, 70), Vector3d(0.1, 0.05, -1));
    const auto before_a_wall = [&](const Solid& solid) -> Solid {
        return [=](const Vector3d& p) { return std::min(solid(p), behind(p)); };
    };
    const std::vector<std::tuple<std::string, Solid, Material, double>> scenes{
        {"head", head(place + Vector3d(0, 0, 90)), dull, 170},
        {"shell", shell(place), pale, 170},
        {"shell on a wall", before_a_wall(shell(place)), glossy, 120},
        {"shell on a wall, overexposed", before_a_wall(shell(place)), glossy, 330},
        {"shell on a wall, dim", before_a_wall(shell(place)), pale, 35},
        {"folds of 12 mm", folds(place, 12), dull, 170},
        {"folds of 30 mm", before_a_wall(folds(place, 30)), pale, 170}};
    for (const auto& [name, solid, material, white_grey] : scenes) {
        if (name.find(only) == std::string::npos) continue;
        Room room = desk_room(solid);
        room.material = material;
        room.photography.white_grey = white_grey;
        measure(name, room, folder);
    }
    return 0;
}
