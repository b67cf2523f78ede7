#include "planning_io/dicom/choose_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "planning_io/dicom/storage_class.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/volume_checks.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

/// "0.5 x 0.5 x 1.25 mm" of what is known, for people.
std::string spacing_text(const DicomSeries& series) {
    const auto slices = series.all_slices();
    if (slices.empty() || !std::isfinite(slices.front().column_spacing_mm)) return "-";
    std::string text = fmt::format("{:.3g} x {:.3g}", slices.front().column_spacing_mm, slices.front().row_spacing_mm);
    const Eigen::Vector3d normal = slices.front().row_direction.cross(slices.front().column_direction);
    if (std::any_of(slices.begin(), slices.end(), [](const auto& s) { return !s.position_in_ct.allFinite(); }) ||
        slices.size() < 2)
        return text + " mm";
    const auto [first, last] = std::minmax_element(slices.begin(), slices.end(), [&](const auto& a, const auto& b) {
        return normal.dot(a.position_in_ct) < normal.dot(b.position_in_ct);
    });
    return text + fmt::format(" x {:.3g} mm", (last->position_in_ct - first->position_in_ct).norm() /
                                                  static_cast<double>(slices.size() - 1));
}

std::string table_of(const std::vector<DicomSeries>& list) {
    std::string table = "\n  number  modality  slices  spacing  UID  \"description\"";
    for (const auto& s : list)
        table += fmt::format("\n  {}  {}  {}  {}  {}  \"{}\"{}", s.number.empty() ? "-" : s.number, s.modality,
                             s.slices(), spacing_text(s), s.uid, s.description,
                             s.slices() == 0 ? " (no pictures)"
                             : s.is_volume() ? ""
                             : is_x_ray_3d(s.files.front().storage_class)
                                 ? " (" + words_of_class(s.files.front().storage_class, s.modality) + ")"
                                 : " (no CT or MR volume)");
    return table;
}

/// Whether a file that does not say of which series it is names this one, or its frame of reference, somewhere in its
/// first megabyte: then it is a damaged slice of it.
bool names_series(const fs::path& file, const DicomSeries& series) {
    std::string bytes(std::size_t{1} << 20, '\0');
    std::ifstream in(file, std::ios::binary);
    in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(in.gcount()));
    std::vector<std::string> uids{series.uid};
    for (const auto& slice : series.all_slices())
        if (!slice.frame_of_reference_uid.empty()) uids.push_back(slice.frame_of_reference_uid);
    std::sort(uids.begin(), uids.end());
    uids.erase(std::unique(uids.begin(), uids.end()), uids.end());
    return std::any_of(uids.begin(), uids.end(),
                       [&](const std::string& uid) { return bytes.find(uid) != std::string::npos; });
}

bool holds(const DicomSeries& series, const fs::path& path) {
    std::error_code error;
    return std::any_of(series.files.begin(), series.files.end(),
                       [&](const DicomFile& f) { return fs::equivalent(f.path, path, error); });
}

}  // namespace

DicomSeries choose_series(const DicomFolder& folder, const fs::path& path, const std::string& wanted) {
    std::vector<DicomSeries> chosen;
    const bool is_folder = fs::is_directory(path);
    const bool says_folder = is_folder || is_dicom_directory(path);
    for (const DicomSeries& s : folder.series)
        if (!wanted.empty() ? s.uid == wanted || s.number == wanted : says_folder ? s.is_volume() : holds(s, path))
            chosen.push_back(s);
    if (chosen.size() > 1 && wanted.empty() &&
        std::any_of(chosen.begin(), chosen.end(), [](const auto& s) { return s.slices() >= kFewestSlices; }))
        std::erase_if(chosen,
                      [](const DicomSeries& s) { return s.slices() < kFewestSlices; });  // a few slices are no rival
    for (const auto& file : folder.unreadable)  // of others, a damaged file does not matter
        if (fs::equivalent(file, path) || (says_folder && chosen.empty()) ||
            std::any_of(chosen.begin(), chosen.end(), [&](const auto& s) { return names_series(file, s); }))
            throw DamagedFileError(
                file, "is a DICOM file that is damaged or does not say of which series it is",
                "Copy or export the series again; if the file is not of the series, move it elsewhere.");
    if (!says_folder && wanted.empty() && chosen.empty())
        throw InputError(
            path, "is no DICOM file, nor any other kind of volume that is read",
            "Name a folder with a CT or MR series, or a file: .nii, .nii.gz, .nrrd, .nhdr, .mha, .mhd, .inv3.");
    if (folder.series.empty())
        throw InputError(
            path, "holds no DICOM images",
            "Name a folder with a CT or MR series, or a file: .nii, .nii.gz, .nrrd, .nhdr, .mha, .mhd, .inv3.");
    if (chosen.empty())
        throw InputError(
            path,
            (wanted.empty() ? "holds no CT or MR volume; there is:"
                            : "holds no series of the UID or number " + wanted + "; there is:") +
                table_of(folder.series),
            std::ranges::any_of(folder.series,
                                [](const DicomSeries& s) { return is_x_ray_3d(s.files.front().storage_class); })
                ? kExportAsCt
            : wanted.empty() ? "Name a folder with a CT or MR series of slices."
                             : "Choose one of these by its UID (--series UID).");
    if (chosen.size() > 1 && wanted.empty() && chosen.front().slices() < kFewestSlices)
        throw InputError(path,
                         fmt::format("holds no CT or MR volume of {} slices or more; there is:", kFewestSlices) +
                             table_of(folder.series),
                         "Name a folder with a CT or MR series of thin slices.");
    if (chosen.size() > 1)
        throw InputError(path, "holds several series:" + table_of(wanted.empty() ? folder.series : chosen),
                         "Choose one by its UID (--series UID).");
    return chosen.front();
}

}  // namespace planlight
