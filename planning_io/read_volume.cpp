#include "planning_io/read_volume.h"

#include "planning_io/content_hash.h"
#include "planning_io/invesalius_project.h"
#include "planning_io/types/error.h"

namespace planlight {

namespace fs = std::filesystem;

Volume read_volume(const fs::path& path, const std::string&) {
    if (!fs::exists(path)) throw InputError(path, "does not exist", "Check the name of the project or folder.");
    if (path.extension() == ".inv3") return read_invesalius_volume(path);
    throw InputError(path, "is not an InVesalius project", "Name a project that InVesalius 3 saved (.inv3).");
}

std::string hash_of(const Volume& volume) {
    ContentHash hash;
    hash.add("planlight volume 1");
    hash.add_values(volume.size.data(), 3);
    const Eigen::Matrix4d matrix = volume.ct_from_voxel.matrix();
    hash.add_values(matrix.data(), 16);
    hash.add(volume.is_hu ? "HU" : "as stored");
    hash.add(volume.modality);
    hash.add_values(volume.values.data(), volume.values.size());
    return hash.hex();
}

}  // namespace planlight
