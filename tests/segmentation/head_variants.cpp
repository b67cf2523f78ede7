#include "tests/segmentation/head_variants.h"

#include <zlib.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>

#include "planning_io/types/statistics.h"
#include "planning_io/volume/volume_sample.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

constexpr double kCut_mm = 45, kNoise = 0.02, kShading = 2, kTurn_degrees = 25;

std::pair<float, float> contrast_of(const Volume& volume) {
    std::vector<float> sample;
    for (std::size_t v = 0; v < volume.values.size(); v += 61)
        if (std::isfinite(volume.values[v])) sample.push_back(volume.values[v]);
    return {quantile(sample, 0.1), quantile(sample, 0.95)};
}

/// Stored with the last axis first and all three backwards.
Volume permuted(const Volume& volume) {
    Volume other = volume;
    other.size = {volume.size[2], volume.size[0], volume.size[1]};
    const Eigen::Matrix3d& of = volume.ct_from_voxel.linear();
    other.ct_from_voxel.linear() << -of.col(2), -of.col(0), -of.col(1);
    other.ct_from_voxel.translation() =
        volume.ct_from_voxel * Vector3d(volume.size[0] - 1, volume.size[1] - 1, volume.size[2] - 1);
    for (int k = 0; k < other.size[2]; ++k)
        for (int j = 0; j < other.size[1]; ++j)
            for (int i = 0; i < other.size[0]; ++i)
                other.values[other.index(i, j, k)] =
                    volume.at(volume.size[0] - 1 - j, volume.size[1] - 1 - k, volume.size[2] - 1 - i);
    return other;
}

/// On a grid turned about the middle; what lay outside shows the least value.
Volume turned(const Volume& volume) {
    Volume other = volume;
    const Vector3d middle =
        volume.ct_from_voxel * Vector3d(volume.size[0] / 2.0, volume.size[1] / 2.0, volume.size[2] / 2.0);
    const Eigen::AngleAxisd turn(kTurn_degrees * M_PI / 180, Vector3d(1, 2, -1).normalized());
    other.ct_from_voxel = Eigen::Translation3d(middle) * turn * Eigen::Translation3d(-middle) * volume.ct_from_voxel;
    const Eigen::Affine3d voxel = volume.ct_from_voxel.inverse() * other.ct_from_voxel;
    const float least = *std::min_element(volume.values.begin(), volume.values.end());
    for (int k = 0; k < other.size[2]; ++k)
        for (int j = 0; j < other.size[1]; ++j)
            for (int i = 0; i < other.size[0]; ++i)
                other.values[other.index(i, j, k)] = static_cast<float>(
                    value_at(volume, voxel * Vector3d(i, j, k)).value_or(static_cast<double>(least)));
    return other;
}

Volume noisy(Volume volume) {
    const auto [low, high] = contrast_of(volume);
    const double contrast = static_cast<double>(high - low), least = static_cast<double>(low);
    std::mt19937 random(7);
    std::normal_distribution<double> normal(0, kNoise * contrast);
    const Vector3d middle =
        volume.ct_from_voxel * Vector3d(volume.size[0] / 2.0, volume.size[1] / 2.0, volume.size[2] / 2.0);
    for (int k = 0; k < volume.size[2]; ++k)
        for (int j = 0; j < volume.size[1]; ++j)
            for (int i = 0; i < volume.size[0]; ++i) {
                const Vector3d p = volume.ct_from_voxel * Vector3d(i, j, k) - middle;
                float& value = volume.values[volume.index(i, j, k)];
                const double shaded = (static_cast<double>(value) - least) * std::pow(kShading, (p.x() + p.y()) / 280);
                value = static_cast<float>(least + std::hypot(shaded + normal(random), normal(random)));
            }
    return volume;
}

/// Without what lies within kCut_mm of the head's end towards `out` (an axis of ct): the voxel planes most nearly
/// across it are taken away.
Volume cut(const Volume& volume, const Vector3d& out) {
    int axis = 0;
    const Vector3d along = volume.ct_from_voxel.linear().transpose() * out;
    along.cwiseAbs().maxCoeff(&axis);
    const auto a = static_cast<std::size_t>(axis);
    const bool at_end = along[axis] > 0;
    const auto [low, high] = contrast_of(volume);
    const auto& size = volume.size;
    std::vector<std::size_t> filled(static_cast<std::size_t>(size[a]), 0);
    for (int k = 0; k < size[2]; ++k)
        for (int j = 0; j < size[1]; ++j)
            for (int i = 0; i < size[0]; ++i)
                filled[static_cast<std::size_t>(std::array<int, 3>{i, j, k}[a])] +=
                    volume.at(i, j, k) > low + 0.3F * (high - low);
    const double face_mm2 = volume.spacing_mm().prod() / volume.spacing_mm()[axis];
    const auto is_head = [&](int n) {
        return static_cast<double>(filled[static_cast<std::size_t>(n)]) * face_mm2 > 150;
    };
    int first = 0, last = size[a] - 1;
    while (first < last && !is_head(first)) ++first;
    while (last > first && !is_head(last)) --last;
    const int planes = static_cast<int>(kCut_mm / volume.spacing_mm()[axis]);
    const int from = at_end ? 0 : std::min(first + planes, size[a] - 4),
              to = at_end ? std::max(last - planes, 4) : size[a];
    Volume part = volume;
    part.size[a] = to - from;
    Vector3d offset = Vector3d::Zero();
    offset[axis] = from;
    part.ct_from_voxel.translation() = volume.ct_from_voxel * offset;
    part.values.clear();
    for (int k = 0; k < part.size[2]; ++k)
        for (int j = 0; j < part.size[1]; ++j)
            for (int i = 0; i < part.size[0]; ++i) {
                std::array<int, 3> at{i, j, k};
                at[a] += from;
                part.values.push_back(volume.at(at[0], at[1], at[2]));
            }
    return part;
}

}  // namespace

std::vector<HeadVariant> variants_of(const Volume& volume) {
    std::vector<HeadVariant> all;
    all.push_back({"other axes", permuted(volume)});
    all.push_back({"turned grid", turned(volume)});
    if (!volume.is_hu) all.push_back({"noise and shading", noisy(volume)});
    all.push_back({"no crown", cut(volume, Vector3d::UnitZ()), true});
    all.push_back({"no chin", cut(volume, -Vector3d::UnitZ()), true});
    all.push_back({"no face", cut(volume, -Vector3d::UnitY()), true});
    return all;
}

std::filesystem::path without_words(const std::filesystem::path& path, const std::filesystem::path& folder) {
    if (!path.filename().string().ends_with(".nii.gz")) return path;
    std::string bytes;
    gzFile file = gzopen(path.c_str(), "rb");
    if (file == nullptr) return path;
    std::vector<char> part(1 << 20);
    for (int n; (n = gzread(file, part.data(), static_cast<unsigned>(part.size()))) > 0;)
        bytes.append(part.data(), static_cast<std::size_t>(n));
    gzclose(file);
    if (bytes.size() < 352) return path;
    // nifti1.h: data_type and db_name, descrip and aux_file, intent_name.
    for (const auto& [at, length] : {std::pair(4, 28), std::pair(148, 104), std::pair(328, 16)})
        std::fill_n(bytes.begin() + at, length, '\0');
    std::filesystem::create_directories(folder);
    const auto result = folder / "volume.nii";
    std::ofstream(result, std::ios::binary) << bytes;
    return result;
}

}  // namespace planlight::test
