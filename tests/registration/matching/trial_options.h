#pragma once

#include <filesystem>

#include "tests/registration/matching/trial_heads.h"

namespace planlight::test {

/// The command line of the measuring programs: [TRIALS [SEED]] [--ch2 FILE] [--mannequin FILE] [--ct-head FOLDER]
/// [--volume FILE]... [--log FILE]
/// [--picture FILE] [--plain] [--to-refuse]. The mannequin and the CT head are also looked for among the third-party
/// data. Exits with 2 and the usage on anything else.
struct TrialOptions {
    unsigned trials = 0, seed = 1;
    TrialHeadFiles files;
    std::filesystem::path log, picture;
    bool plain = false;      ///< only of measure_initial_match: nothing hard in any trial
    bool to_refuse = false;  ///< only of measure_draped: only scenes that must be refused
};
TrialOptions trial_options(int argc, char** argv, unsigned default_trials);

}  // namespace planlight::test
