// Scans of solids with seams, folds and thin ridges under light that goes from wall to wall
// (tests/registration/scan/solid_room): measure_solids [DIR] prints, a solid and a set of pictures a line, what the
// clean cloud is off the true surface; with DIR it leaves a camera's white picture and the clouds there.
#include <fmt/format.h>

#include <filesystem>
#include <map>

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

std::vector<Set> sets_of(const Room& room) {
    StripeSettings full;
    full.width = room.projector.width, full.height = room.projector.height;
    StripeSettings gray = full;
    gray.phase_steps = 0, gray.phase_period_px = 2;
    std::vector<StripePattern> patterns{{StripePattern::Kind::white, false, 0, "white"},
                                        {StripePattern::Kind::black, false, 0, "black"}};
    for (const bool rows : {false, true})
        for (auto& pattern : gray_patterns(10, rows, true)) patterns.push_back(pattern);
    return {{"full", full, {}},
            {"full, left only", full, {}, true},
            {"Gray code", gray, patterns},
            {"fast", fast_stripes(full.width, full.height), {}},
            {"multi-frequency", multi_frequency_stripes(full.width, full.height), {}}};
}

double share_over(const std::vector<double>& off, double limit) {
    return off.empty() ? 0
                       : static_cast<double>(off.end() - std::lower_bound(off.begin(), off.end(), limit)) /
                             static_cast<double>(off.size());
}

void measure(const std::string& name, const Room& room, const std::filesystem::path& folder) {
    for (const Set& set : sets_of(room)) {
        ScanCapture shot = capture(room, set.stripes, set.patterns);
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
            if (!folder.empty())
                write_cloud(scan.clean.kept, folder / (name + "-" + std::to_string(set.name.size()) + ".ply"));
        } catch (const Error& refused) {
            fmt::print("| {} | {} | refused: {} |\n", name, set.name, refused.what());
        }
        std::fflush(stdout);
    }
}

}  // namespace

int main(int argc, char** argv) {
    const std::filesystem::path folder = argc > 1 ? argv[1] : "";
    if (!folder.empty()) std::filesystem::create_directories(folder);
    const Vector3d place(15, -10, 600);
    fmt::print(
        "| solid | set | points | median (mm) | 95 % | over 1 mm | over 5 mm |\n|---|---|---|---|---|---|---|\n");
    const auto room_with = [&](Solid solid, const Material& material) {
        Room room = desk_room(std::move(solid));
        room.material = material;
        return room;
    };
    Material dull{0.6, 1, 0, 60, 0.8, 0.1}, pale{0.85, 1, 0.25, 40, 1.5, 0.05};
    measure("head", room_with(head(place + Vector3d(0, 0, 90)), dull), folder);
    measure("shell", room_with(shell(place), pale), folder);
    measure("folds 12 mm", room_with(folds(place, 12), dull), folder);
    measure("folds 30 mm, pale", room_with(folds(place, 30), pale), folder);
    return 0;
}
