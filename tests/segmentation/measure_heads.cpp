#include <fmt/format.h>
#include <chrono>
#include "planning_io/files/image_file.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
#include "segmentation/segment_skin.h"
#include "segmentation/skin_judgement.h"
#include "segmentation/skin_layers.h"
#include "tests/segmentation/head_sheet.h"
using namespace planlight;
int main(int argc, char** argv) {
    for (int a = 1; a < argc; ++a) {
        std::string path = argv[a], name = std::filesystem::path(path).filename().string();
        try {
            Volume volume = read_volume(path);
            auto t0 = std::chrono::steady_clock::now();
            SkinMask m = segment_skin(volume);
            auto t1 = std::chrono::steady_clock::now();
            TriangleMesh skin = triangulate_skin(volume, m);
            auto t2 = std::chrono::steady_clock::now();
            SkinJudgement j = judge_skin(volume, m, skin);
            auto t3 = std::chrono::steady_clock::now();
            size_t n[3] = {0,0,0}; for (auto f : skin.flags) n[f]++;
            fmt::print("{} thr {:.4g} vol {:.0f} removed {} {:.1f} smooth {} blank {} bright {:.2f} unsure {:.3f} tris {} skin {} seal {} cut {} time {:.2f} {:.2f} {:.2f}\n", name, m.threshold_said, m.volume_ml, m.pieces_removed, m.removed_ml, m.smoothings, m.blank ? *m.blank : -1.F, m.brightness_ratio, m.unsure_share, skin.triangles.size(), n[0], n[1], n[2], std::chrono::duration<double>(t1 - t0).count(), std::chrono::duration<double>(t2 - t1).count(), std::chrono::duration<double>(t3 - t2).count());
            fmt::print("   ball {:.0f} layered {:.2f} scalp {:.1f} nose {:.1f} blur {:.1f} gap {:.1f} sigma {:.2f} brightbone {}\n", j.ball_radius_mm, j.layered_share, j.scalp_mm, j.nose_mm, j.edge_blur_mm, j.gap_cm2, j.sigma_mm, j.bright_bone);
            SkinLayers l = layers_under(volume, m, skin, j.ball_centre_in_ct); fmt::print("   faint {:.2f} dip {:.2f} blank air {}\n", l.faint_share, l.dip, l.air_is_blank);
            for (auto& c : j.cut_sides) fmt::print("   cut {} {:.0f} {}\n", c.name, c.area_cm2, c.usual);
            for (auto& w : m.warnings) fmt::print("    mask: {}\n", w);
            for (auto& w : j.doubts) fmt::print("    doubt: {}\n", w.finding);
            for (auto& w : j.refusals) fmt::print("    REFUSED: {}\n", w.finding);
            write_png(test::head_sheet(volume, skin), "/tmp/skin/out/" + name + ".png");
        } catch (const Error& e) { fmt::print("== {} ERROR {}\n", name, e.what()); } 
        std::fflush(stdout);
    }
}
