// Heads made from the CT of the example patient (or another in HU) with the contrast and the faults of an MR: right,
// warned, refused, wrong. measure_mr_draws FIRST_SEED COUNT [LEAST_VOXEL_MM [PICTURES]] [--ct VOLUME] [--fat-shift MM]
// [--noise SHARE] [--skin MM]. Right: at most 1 % of the true skin lies further than 2 mm from ours; wrong: more, and
// taken without a warning.
#include <fmt/format.h>

#include <cstdlib>

#include "planning_io/files/image_file.h"
#include "planning_io/volume/read_volume.h"
#include "tests/segmentation/head_sheet.h"
#include "tests/segmentation/mr_like.h"
#include "tests/segmentation/skin_score.h"
#include "tests/support/test_data.h"

int main(int argc, char** argv) {
    using namespace planlight;
    using namespace planlight::test;
    std::vector<std::string> words(argv + 1, argv + argc);
    std::string of = example_patient() ? example_patient()->string() : "";
    MrLook look;
    for (std::size_t w = 0; w + 1 < words.size();) {
        if (words[w] == "--ct")
            of = words[w + 1];
        else if (words[w] == "--fat-shift")
            look.fat_shift_mm = std::stod(words[w + 1]);
        else if (words[w] == "--noise")
            look.noise = std::stod(words[w + 1]);
        else if (words[w] == "--skin")
            look.skin_mm = std::stod(words[w + 1]);
        else {
            ++w;
            continue;
        }
        words.erase(words.begin() + static_cast<long>(w), words.begin() + static_cast<long>(w) + 2);
    }
    if (words.size() < 2 || of.empty()) {
        fmt::print(stderr,
                   "measure_mr_draws FIRST_SEED COUNT [LEAST_VOXEL_MM [PICTURES]] [--ct VOLUME] [--fat-shift MM] "
                   "[--noise SHARE] [--skin MM]; without --ct it needs Debian's invesalius-examples\n");
        return 2;
    }
    const auto first = static_cast<std::uint32_t>(std::stoi(words[0])),
               count = static_cast<std::uint32_t>(std::stoi(words[1]));
    if (words.size() > 2) look.least_mm = std::stod(words[2]);
    const Volume ct = read_volume(of);
    const SkinMask body = segment_skin(ct);
    const TriangleMesh truth = triangulate_skin(ct, body);
    int right = 0, warned = 0, refused = 0, wrong = 0;
    for (std::uint32_t seed = first; seed < first + count; ++seed) {
        const MrDraw draw = mr_like(ct, body, seed, look);
        const SkinScore score = score_of(draw.volume, truth);
        if (words.size() > 3 && !score.skin.triangles.empty())
            write_png(head_sheet(draw.volume, score.skin), fmt::format("{}/{}.png", words[3], seed));
        const char* verdict = score.refused               ? "refused"
                              : score.taken_wrongly()     ? "WRONG"
                              : !(score.off_percent <= 1) ? "warned"
                                                          : "right";
        (score.refused ? refused : score.taken_wrongly() ? wrong : !(score.off_percent <= 1) ? warned : right) += 1;
        fmt::print("{}\t{}\t{:.2f} % off\tp95 {:.2f} mm\trms {:.2f}\tsigma {:.2f}, by noise {:.2f}\t{}\t{}\n", seed,
                   verdict, score.off_percent, score.p95_mm, score.rms_mm, score.sigma_mm, score.noise_sigma_mm,
                   draw.said, score.why);
        std::fflush(stdout);
    }
    fmt::print("{} draws: {} right, {} warned, {} refused, {} wrong\n", count, right, warned, refused, wrong);
    return wrong == 0 ? 0 : 6;
}
