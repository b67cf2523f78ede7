#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace planlight::test {

/// What became of damaged meshes and clouds: of each reader that was given them.
struct ShapeMutationCounts {
    int files = 0, readings = 0, read = 0, refused = 0, damaged = 0;
    int child_crashes = 0;  ///< of VTK's readers, in the child that they have
    int not_an_error = 0;   ///< anything thrown that is none of our errors: a fault of ours
    double slowest_s = 0;   ///< processor time of one reading
    std::map<std::string, int> read_by_format;
    std::vector<std::string> faults;
};

/// Damages sound files of every format that meshes, lines and clouds are read from (PLY in text and both byte orders,
/// with faces before vertices, lists among the columns, unknown elements; STL, OBJ, VTK, VTP): flipped, overwritten,
/// cut, repeated and swapped bytes, whole lines doubled, moved and taken away, numbers made huge, negative and no
/// number. Each goes to every reader: `read_shape` and `welded`, `read_surface`, `read_mesh`, `read_cloud`,
/// `import_plan`. PLY, STL and OBJ are parsed in this process, so that a build with AddressSanitizer sees every step
/// out of bounds. A file that is a fault is kept in `keep_in`, unless that is empty.
ShapeMutationCounts mutate_shapes(int files, unsigned seed, const std::filesystem::path& keep_in = {});

}  // namespace planlight::test
