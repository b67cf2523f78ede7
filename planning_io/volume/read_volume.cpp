#include "planning_io/volume/read_volume.h"

#include <functional>

#include "planning_io/dicom/dicom_series.h"
#include "planning_io/files/check_exists.h"
#include "planning_io/files/content_hash.h"
#include "planning_io/files/header_text.h"
#include "planning_io/files/sandboxed_process.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/fill_corners.h"
#include "planning_io/volume/invesalius_project.h"
#include "planning_io/volume/metaimage_file.h"
#include "planning_io/volume/mgh_file.h"
#include "planning_io/volume/nifti_file.h"
#include "planning_io/volume/nrrd_file.h"
#include "planning_io/volume/slice_faults.h"
#include "planning_io/volume/volume_checks.h"
#include "planning_io/volume/volume_in_child.h"

namespace planlight {

namespace fs = std::filesystem;

namespace {

/// What the file formats have in common once their voxels are read.
Volume checked(Volume volume, const fs::path& path) {
    if (volume.modality.empty()) tell_modality_by_values(volume);
    make_right_handed(volume);
    fill_corners(volume);
    check_for_skin(volume, path);
    note_slice_faults(volume);
    return volume;
}

Volume parse_volume(const fs::path& path, const std::string& series, SliceGaps gaps, SeriesIdentity* identity) {
    const std::string name = lower_case(path.filename().string());
    if (fs::is_directory(path)) return parse_dicom_series(path, series, gaps, {}, identity);
    if (name.ends_with(".inv3")) return checked(read_invesalius_volume(path), path);
    if (name.ends_with(".nii") || name.ends_with(".nii.gz")) return checked(parse_nifti(path), path);
    if (name.ends_with(".mgh") || name.ends_with(".mgz")) return checked(parse_mgh(path), path);
    if (name.ends_with(".nrrd") || name.ends_with(".nhdr")) return checked(parse_nrrd(path), path);
    if (name.ends_with(".mha") || name.ends_with(".mhd")) return checked(parse_metaimage(path), path);
    if (name.ends_with(".hdr") || name.ends_with(".img"))
        throw InputError(path, "is an Analyze file or half of a NIfTI pair, which may not say left from right",
                         "Convert the DICOM series to one .nii.gz, or give the DICOM series.");
    return parse_dicom_series(path, series, gaps, {}, identity);
}

}  // namespace

Volume read_volume(const fs::path& path, const std::string& series, SliceGaps gaps, SeriesIdentity* identity) {
    std::error_code error;
    check_exists(path, "Check the name of the file or folder.");
    if (!fs::is_regular_file(path, error) && !fs::is_directory(path, error))
        throw InputError(path, "is neither a file nor a folder", "Name a file or folder.");
    try {
        return volume_in_child(
            path, [&] { return parse_volume(path, series, gaps, identity); }, identity);
    } catch (const ParserCrash&) {  // of a DICOM folder perhaps a file of somebody else's
        if (!fs::is_directory(path)) throw;
        const std::vector<fs::path> crashing = crashing_files_of(path);
        if (crashing.empty()) throw;
        return volume_in_child(
            path, [&] { return parse_dicom_series(path, series, gaps, crashing, identity); }, identity);
    }
}

void make_anonymous(Volume& volume) {
    volume.source = volume.modality + " volume";
    volume.frame_of_reference_uid.clear();
    volume.series_description.clear();
    volume.series_date.clear();
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
