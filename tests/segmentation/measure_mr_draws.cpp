// Heads made from the CT of the example patient with the contrast and the faults of an MR: right, warned, refused,
// wrong. measure_mr_draws FIRST_SEED COUNT [LEAST_VOXEL_MM [PICTURES]]. Wrong: accepted (with a warning or not) with
// more than 1 % of the true skin further than 2 mm from ours, on draws whose fat shift and steps do not move the skin
// themselves.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "planning_io/files/image_file.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
#include "segmentation/skin_judgement.h"
#include "tests/segmentation/distance_to_mesh.h"
#include "tests/segmentation/head_sheet.h"
#include "tests/segmentation/mr_like.h"
#include "tests/support/test_data.h"

int main(int argc, char** argv) {
    using namespace planlight;
    using namespace planlight::test;
    if (argc < 3 || !example_patient()) {
        fmt::print(stderr, "measure_mr_draws FIRST_SEED COUNT [LEAST_VOXEL_MM]; needs Debian's invesalius-examples\n");
        return 2;
    }
    const auto first = static_cast<std::uint32_t>(std::atoi(argv[1])),
               count = static_cast<std::uint32_t>(std::atoi(argv[2]));
    const double least_mm = argc > 3 ? std::atof(argv[3]) : 0.8;
    const Volume ct = read_volume(*example_patient());
    const SkinMask body = segment_skin(ct);
    const TriangleMesh truth = triangulate_skin(ct, body);
    int right = 0, warned = 0, refused = 0, wrong = 0;
    for (std::uint32_t seed = first; seed < first + count; ++seed) {
        const MrDraw draw = mr_like(ct, body, seed, least_mm);
        std::string verdict, why;
        double off = NAN, p95 = NAN;
        try {
            const SkinMask mask = segment_skin(draw.volume);
            const TriangleMesh skin = triangulate_skin(draw.volume, mask);
            const SkinJudgement judged = judge_skin(draw.volume, mask, skin);
            if (argc > 4) write_png(head_sheet(draw.volume, skin), fmt::format("{}/{}.png", argv[4], seed));
            refuse_implausible(judged);
            TriangleMesh lids = skin;  // flagged as no skin: what lies behind is not counted
            std::erase_if(lids.triangles, [&](const auto& t) {
                return std::all_of(t.begin(), t.end(),
                                   [&](auto c) { return skin.flags[static_cast<std::size_t>(c)] == kSkin; });
            });
            const DistanceToMesh distance(skin), from_lid(lids);
            std::vector<double> mm;
            for (std::size_t v = 0; v < truth.vertices_in_ct.size(); v += 7) {
                if (truth.flags[v] != kSkin) continue;
                const double here = distance(truth.vertices_in_ct[v]);
                if (here < 0.5 || from_lid(truth.vertices_in_ct[v]) > here + 0.5) mm.push_back(here);
            }
            std::sort(mm.begin(), mm.end());
            p95 = mm[mm.size() * 95 / 100];
            off = 100.0 * static_cast<double>(mm.end() - std::upper_bound(mm.begin(), mm.end(), 2.0)) /
                  static_cast<double>(mm.size());
            const bool doubted = std::any_of(judged.doubts.begin(), judged.doubts.end(), [](const SkinDoubt& d) {
                return !d.finding.starts_with("The volume ends");
            });
            verdict = off > 1 ? (doubted ? "warned" : "WRONG") : "right";
            for (const SkinDoubt& d : judged.doubts) why += d.finding.substr(0, 60) + "; ";
        } catch (const Error& error) {
            verdict = "refused";
            why = error.what();
        }
        (verdict == "right" ? right : verdict == "warned" ? warned : verdict == "refused" ? refused : wrong) += 1;
        fmt::print("{}\t{}\t{:.2f} % off\tp95 {:.2f} mm\t{}\t{}\n", seed, verdict, off, p95, draw.said, why);
        std::fflush(stdout);
    }
    fmt::print("{} draws: {} right, {} warned, {} refused, {} wrong\n", count, right, warned, refused, wrong);
    return wrong == 0 ? 0 : 6;
}
