#include "planning_io/read_volume.h"

#include "planning_io/content_hash.h"
#include "planning_io/invesalius_project.h"
#include "planning_io/read_dicom.h"
#include "planning_io/types/error.h"

namespace planlight {

namespace fs = std::filesystem;

Volume read_volume(const fs::path& path, const std::string& series_uid) {
    if (!fs::exists(path)) throw InputError(path, "does not exist", "Check the name of the project or folder.");
    return path.extension() == ".inv3" ? read_invesalius_volume(path) : read_dicom_series(path, series_uid);
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
