#include "planning_io/volume/volume_in_child.h"

#include <algorithm>
#include <cstdint>

#include "planning_io/files/sandboxed_process.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMinProcessor_s = 1, kMaxProcessor_s = 240;
constexpr std::uintmax_t kSlowestBytes_s = 1'000'000;  // every sound file is unpacked much faster
constexpr unsigned kMaxWait_s = 300;
constexpr std::uint64_t kMaxNotes = 100;

void put_volume(Parcel& parcel, const Volume& volume) {
    parcel.put(volume.size);
    const Eigen::Matrix4d matrix = volume.ct_from_voxel.matrix();
    for (Eigen::Index i = 0; i < 16; ++i) parcel.put(matrix(i));
    parcel.put(volume.is_hu);
    for (const auto& text :
         {volume.modality, volume.frame_of_reference_uid, volume.source, volume.series_description, volume.series_date})
        parcel.put(text);
    for (const double mm : volume.fat_shift_in_ct) parcel.put(mm);
    parcel.put(volume.widest_gap_mm);
    parcel.put(static_cast<std::uint64_t>(volume.notes.size()));
    for (const auto& note : volume.notes) parcel.put(note);
    parcel.put(volume.values);
}

Volume get_volume(Parcel& parcel) {
    Volume volume;
    volume.size = parcel.get<std::array<int, 3>>();
    Eigen::Matrix4d matrix;
    for (Eigen::Index i = 0; i < 16; ++i) matrix(i) = parcel.get<double>();
    volume.ct_from_voxel.matrix() = matrix;
    volume.is_hu = parcel.get<bool>();
    volume.modality = parcel.get_text();
    volume.frame_of_reference_uid = parcel.get_text();
    volume.source = parcel.get_text();
    volume.series_description = parcel.get_text();
    volume.series_date = parcel.get_text();
    for (double& mm : volume.fat_shift_in_ct) mm = parcel.get<double>();
    volume.widest_gap_mm = parcel.get<double>();
    const auto notes = parcel.get<std::uint64_t>();
    for (std::uint64_t n = 0; n < notes; ++n) {
        std::string note = parcel.get_text();
        if (n < kMaxNotes) volume.notes.push_back(std::move(note));
    }
    volume.values = parcel.get_list<float>();
    return volume;
}

/// Processor time that a sound file or folder of this size does not need.
std::uintmax_t processor_limit_s(const fs::path& path) {
    std::uintmax_t bytes = 0;
    std::error_code error;
    if (fs::is_regular_file(path, error)) bytes = fs::file_size(path, error);
    std::uintmax_t files = 0;
    if (const fs::path folder = fs::is_directory(path, error) ? path : path.parent_path();
        fs::is_directory(folder, error))
        for (fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error), end;
             !error && entry != end && files < 100000; entry.increment(error))
            if (std::error_code ignored; entry->is_regular_file(ignored)) bytes += entry->file_size(ignored), ++files;
    return std::min(kMaxProcessor_s, kMinProcessor_s + bytes / kSlowestBytes_s + files / 500);
}

}  // namespace

Volume volume_in_child(const fs::path& path, const std::function<Volume()>& parse, SeriesIdentity* identity) {
    ChildLimits limits{"volume"};
    limits.processor_s = static_cast<unsigned>(processor_limit_s(path));
    limits.wait_s = kMaxWait_s;
    limits.when_too_large = "Close other programs, give one series alone, or resample the volume to larger voxels.";
    Parcel parcel = parse_in_child(path, limits, [&](Parcel& to) {
        const Volume volume = parse();
        const SeriesIdentity whose = identity ? *identity : SeriesIdentity{};
        for (const auto& text : {whose.patient_hash, whose.study_uid, whose.series_uid}) to.put(text);
        put_volume(to, volume);
    });
    try {
        SeriesIdentity whose;
        for (std::string* text : {&whose.patient_hash, &whose.study_uid, &whose.series_uid}) *text = parcel.get_text();
        if (identity) *identity = whose;
        return get_volume(parcel);
    } catch (const std::out_of_range&) {
        throw DamagedFileError(path, "could not be read to its end",
                               "Copy or export it again from where it came from.");
    }
}

}  // namespace planlight
