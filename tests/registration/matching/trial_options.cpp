#include "tests/registration/matching/trial_options.h"

#include <fmt/format.h>

#include <cstdlib>
#include <map>
#include <string>

#include "tests/support/test_data.h"

namespace planlight::test {

TrialOptions trial_options(int argc, char** argv, unsigned default_trials) {
    TrialOptions options;
    options.trials = default_trials;
    options.files.mannequin = third_party_data("scans/dummyhead.mesh.ply").value_or("");
    options.files.ct_head = third_party_data("ct/slicer_cthead_dicom").value_or("");
    const std::map<std::string, std::filesystem::path*> paths{{"--ch2", &options.files.ch2},
                                                              {"--mannequin", &options.files.mannequin},
                                                              {"--ct-head", &options.files.ct_head},
                                                              {"--log", &options.log},
                                                              {"--picture", &options.picture}};
    int numbers = 0;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (word == "--plain") {
            options.plain = true;
        } else if (word == "--to-refuse") {
            options.to_refuse = true;
        } else if (word == "--volume" && i + 1 < argc) {
            options.files.volumes.emplace_back(argv[++i]);
        } else if (const auto at = paths.find(word); at != paths.end() && i + 1 < argc) {
            *at->second = argv[++i];
        } else if (numbers < 2 && !word.empty() && word.find_first_not_of("0123456789") == std::string::npos) {
            (numbers++ == 0 ? options.trials : options.seed) = static_cast<unsigned>(std::stoul(word));
        } else {
            fmt::print(stderr,
                       "usage: {} [TRIALS [SEED]] [--ch2 FILE] [--mannequin FILE] [--ct-head FOLDER] [--volume "
                       "FILE]... [--log FILE] "
                       "[--picture FILE] [--plain] [--to-refuse]\n",
                       argv[0]);
            std::exit(2);
        }
    }
    return options;
}

}  // namespace planlight::test
