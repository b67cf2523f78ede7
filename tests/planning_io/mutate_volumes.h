#pragma once

#include <map>
#include <string>
#include <vector>

namespace planlight::test {

struct MutationCounts {
    int mutations = 0, read = 0, refused = 0, damaged = 0, other_errors = 0;
    int parser_crashes = 0;  ///< of the child, which is what it is there for
    std::map<std::string, int> crash_kinds;
    int cut_off = 0;        ///< by the child's limits
    int not_an_error = 0;   ///< anything thrown that is not one of our errors: a fault of ours
    int slow = 0;           ///< more than `kSlowProcessor_s` of processor
    int changed_files = 0;  ///< files that reading made, changed or left behind
    double most_processor_s = 0, most_wall_s = 0, processor_s = 0;
    std::vector<std::string> faults;
};

/// Damages copies of sound volumes of every kind (DICOM of eight transfer syntaxes, Enhanced CT, NIfTI, NRRD,
/// MetaImage, InVesalius) and gives them to read_volume, in turn: flipped bits, overwritten, cut, repeated and swapped
/// bytes, most of them in the headers.
MutationCounts mutate_volumes(int mutations, unsigned seed);

inline constexpr double kSlowProcessor_s = 2;

}  // namespace planlight::test
