// Can the light be read? Plans with names of several kinds on the example patient in simulated rooms, each in a random
// pose; the labels as a simulated camera sees them are read by tesseract (Debian package tesseract-ocr), one by one.
// measure_legibility [POSES [FIRST_SEED [paper|modern|both [camera|eye]]]]   (default 20 poses, seed 1, both, camera;
// eye: an eye in the camera's place, without its blur, pixels and noise)
// PLANLIGHT_PICTURES=folder keeps the projector's pictures, the cameras' and the labels as they were read.
#include <fmt/format.h>

#include <cstdlib>
#include <string>

#include "tests/app/labelled_head.h"
#include "tests/app/read_labels.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

int run(int poses, unsigned first_seed, const std::string& preset, bool eye) {
    if (!example_patient() || !can_read_labels()) {
        fmt::print("the packages invesalius-examples and tesseract-ocr are needed\n");
        return 1;
    }
    const LabelledHead head;
    for (const auto each : {simulation::Preset::paper, simulation::Preset::modern}) {
        const std::string name = each == simulation::Preset::paper ? "paper" : "modern";
        if (preset != "both" && preset != name) continue;
        LabelsRead all;
        for (int i = 0; i < poses; ++i) {
            const unsigned seed = first_seed + static_cast<unsigned>(i);
            const LabelsRead read = head.read(each, seed, eye);
            all.append(read);
            fmt::print(
                "{} {:>3}: {} items, {} labels lit, {} left out, {} names alone; {} read right, {} wrong, {} "
                "as another number; text {:.0f} % of the light\n",
                name, seed, read.items, read.lit, read.left_out, read.name_alone, read.right, read.wrong.size(),
                read.other_number.size(), 100 * read.share_of_text);
            for (const auto& wrong : read.wrong) fmt::print("      {}\n", wrong);
            for (const auto& wrong : read.cards_wrong) fmt::print("      card: {}\n", wrong);
            std::fflush(stdout);
        }
        fmt::print(
            "{} room, {} poses: {} of {} items with a label lit whole; {} of {} labels read right ({:.1f} %), {} "
            "read as another number, {} in no camera's sight; the patient's card lit in {}, seen in {}, read right in "
            "{}\n\n",
            name, poses, all.lit, all.items, all.right, all.lit, all.lit ? 100.0 * all.right / all.lit : 0.0,
            all.other_number.size(), all.unseen, all.cards_lit, all.cards_seen, all.cards_right);
        for (const auto& other : all.other_number) fmt::print("  another number: {}\n", other);
    }
    return 0;
}

}  // namespace
}  // namespace planlight::test

int main(int argc, char** argv) {
    return planlight::test::run(argc > 1 ? std::atoi(argv[1]) : 20,
                                argc > 2 ? static_cast<unsigned>(std::atoi(argv[2])) : 1, argc > 3 ? argv[3] : "both",
                                argc > 4 && std::string(argv[4]) == "eye");
}
