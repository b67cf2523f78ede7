// Strange heads and what is no head, as an MR of the example patient would show them: taken rightly, said, refused, or
// wrong. measure_strange_heads FIRST_SEED COUNT [--only WORD] [--pictures FOLDER] [--ct VOLUME] [--as ct]. --as ct: the
// CT itself is judged, once. Wrong: taken without a warning with more than 1 % of the true skin further than 2 mm off;
// or silent where a warning is due; or refused where all is well.
#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>

#include "planning_io/files/image_file.h"
#include "planning_io/volume/read_volume.h"
#include "tests/segmentation/head_sheet.h"
#include "tests/segmentation/mr_like.h"
#include "tests/segmentation/skin_score.h"
#include "tests/segmentation/strange_heads.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

bool is_as_due(const SkinScore& score, Fate fate) {
    if (fate == Fate::refused) return score.refused;
    if (fate == Fate::said) return score.refused || score.doubted;
    if (fate == Fate::quiet) return !score.refused && !score.doubted && score.off_percent <= 1;
    if (fate == Fate::not_bad) return !score.taken_wrongly();
    return !score.refused && score.off_percent <= 1;
}

/// A CT as a scanner blurs it, weights 1 2 1 along each axis, with noise of 12 HU: what was drawn into it has no edges
/// of a voxel's sharpness, and air not one value.
Volume blurred(Volume ct) {
    const std::array<std::size_t, 3> strides{1, ct.index(0, 1, 0), ct.index(0, 0, 1)};
    for (const std::size_t stride : strides) {
        const std::vector<float> before = ct.values;
        for (std::size_t v = stride; v + stride < before.size(); ++v)
            ct.values[v] = (before[v - stride] + 2 * before[v] + before[v + stride]) / 4;
    }
    std::mt19937 random(1);
    std::normal_distribution<float> noise(0, 12);
    for (float& value : ct.values) value += noise(random);
    return ct;
}

std::string word_for(const SkinScore& score) {
    if (score.refused) return "refused";
    const std::string echo = score.echo > 0 ? fmt::format(", echo {:.2f}", score.echo) : "";
    return fmt::format("{}, {:.2f} % off{}", score.doubted ? "warned" : "taken", score.off_percent, echo);
}

}  // namespace
}  // namespace planlight::test

int main(int argc, char** argv) {
    using namespace planlight;
    using namespace planlight::test;
    std::map<std::string, std::string> options;
    for (int a = 3; a + 1 < argc; a += 2) options[argv[a]] = argv[a + 1];
    if (argc < 3 || (!options.contains("--ct") && !example_patient())) {
        fmt::print(stderr,
                   "measure_strange_heads FIRST_SEED COUNT [--only WORD] [--pictures FOLDER] [--ct VOLUME] [--as ct]; "
                   "without --ct it needs Debian's invesalius-examples\n");
        return 2;
    }
    const auto first = static_cast<std::uint32_t>(std::atoi(argv[1])),
               count = static_cast<std::uint32_t>(std::atoi(argv[2]));
    const Volume ct =
        read_volume(options.contains("--ct") ? std::filesystem::path(options["--ct"]) : *example_patient());
    const SkinMask body = segment_skin(ct);
    const TriangleMesh skin = triangulate_skin(ct, body);
    int all = 0, wrong = 0;
    for (const StrangeCase& strange : strange_heads_of(ct, body, skin)) {
        if (strange.name.find(options["--only"]) == std::string::npos) continue;
        const bool as_ct = options["--as"] == "ct";
        if (as_ct ? strange.only_mr : strange.only_ct) continue;
        const StrangeHead head = strange.make();
        for (std::uint32_t seed = first; seed < (as_ct ? first + 1 : first + count); ++seed) {
            MrDraw draw = as_ct ? MrDraw{strange.sharp ? head.ct : blurred(head.ct), "CT"}
                                : mr_like(head.ct, head.body, seed,
                                          {.least_mm = 1.1, .coil = strange.coil, .contrast = strange.contrast});
            if (strange.spoil) strange.spoil(draw.volume);
            const SkinScore score = score_of(draw.volume, head.skin);
            const bool right = is_as_due(score, strange.fate);
            ++all;
            wrong += !right;
            fmt::print("{}\t{}\t{}\t{}\t{}\t{}\n", strange.name, seed, right ? "" : "WRONG", word_for(score), draw.said,
                       score.why);
            std::fflush(stdout);
            if (options.contains("--pictures") && !score.skin.triangles.empty())
                write_png(head_sheet(draw.volume, score.skin),
                          fmt::format("{}/{} {}.png", options["--pictures"], strange.name, seed));
        }
    }
    fmt::print("{} strange heads, {} not as is due\n", all, wrong);
    return wrong == 0 ? 0 : 6;
}
