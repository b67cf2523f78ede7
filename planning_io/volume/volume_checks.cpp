#include "planning_io/volume/volume_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "planning_io/files/header_text.h"
#include "planning_io/types/error.h"
#include "planning_io/types/statistics.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

constexpr double kMostMagnitude_mm = 1e4, kShortest_mm = 10, kLongest_mm = 3000;
constexpr float kAirBelow_hu = -705;  // where a CT's air is looked for: segmentation/skin_threshold.cpp
constexpr float kDenserThanAir_hu = -300;
constexpr double kLeastAirShare = 0.001, kLeastBody_percent = 0.2;
constexpr const char* kExportAgain = "Export the volume again from the scanner or the archive.";

/// Every voxel, or every few of a large volume.
std::vector<float> sample_of(const Volume& volume) {
    const std::size_t step = std::max<std::size_t>(1, volume.values.size() / 2'000'000);
    std::vector<float> sample;
    for (std::size_t i = 0; i < volume.values.size(); i += step) sample.push_back(volume.values[i]);
    return sample;
}

/// How many of a hundred are at `level` or above; 0 of none.
double percent_from(const std::vector<float>& sample, double level) {
    const auto from = std::ranges::count_if(sample, [&](float v) { return v >= level; });
    return sample.empty() ? 0 : 100.0 * static_cast<double>(from) / static_cast<double>(sample.size());
}

/// Between air and body: -300 HU, or for other values the level that parts them best (Otsu 1979).
double air_level(const Volume& volume, const std::vector<float>& sample, float low, float high) {
    if (volume.is_hu) return kDenserThanAir_hu;
    constexpr int kBins = 256;
    std::vector<double> bins(kBins, 0);
    const double width = (static_cast<double>(high) - low) / kBins;
    for (const float v : sample) bins[static_cast<std::size_t>(std::clamp((v - low) / width, 0.0, kBins - 1.0))] += 1;
    double all = 0, moment = 0, below = 0, moment_below = 0, best = -1;
    int level = 0;
    for (int b = 0; b < kBins; ++b)
        all += bins[static_cast<std::size_t>(b)], moment += b * bins[static_cast<std::size_t>(b)];
    for (int b = 0; b < kBins - 1; ++b) {
        below += bins[static_cast<std::size_t>(b)], moment_below += b * bins[static_cast<std::size_t>(b)];
        if (below == 0 || below == all) continue;
        const double apart = moment_below / below - (moment - moment_below) / (all - below);
        if (const double between = below * (all - below) * apart * apart; between > best) best = between, level = b;
    }
    return low + (level + 1) * width;
}

/// How many of the six sides have air in more than one voxel of a hundred.
int sides_with_air(const Volume& volume, double level) {
    const auto [nx, ny, nz] = volume.size;
    const std::array<int, 3> n{nx, ny, nz};
    int sides = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const int end : {0, n[axis] - 1}) {
            const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
            long air = 0;
            std::array<int, 3> at{};
            at[axis] = end;
            for (at[u] = 0; at[u] < n[u]; ++at[u])
                for (at[v] = 0; at[v] < n[v]; ++at[v]) air += volume.at(at[0], at[1], at[2]) < level;
            sides += 100 * air > static_cast<long>(n[u]) * n[v];
        }
    return sides;
}

/// Of a volume whose file does not say what it is: what was set far below all else, and is no air of a CT, for that is
/// of one value and the least of the others is 0 or above, with air of its own as an MR has it.
void fill_padding(Volume& volume) {
    constexpr float kFarBelow = 500;
    constexpr double kLeastAir = 0.1, kDark = 0.1;
    const float least = *std::min_element(volume.values.begin(), volume.values.end());
    if (least > kAirBelow_hu) return;
    float next = std::numeric_limits<float>::max();
    for (const float v : volume.values)
        if (v > least) next = std::min(next, v);
    if (next < 0 || next - least < kFarBelow || next == std::numeric_limits<float>::max()) return;
    std::vector<float> others;
    for (const float v : sample_of(volume))
        if (v > least) others.push_back(v);
    if (others.size() < 1000) return;
    const double bright = quantile(std::vector<double>(others.begin(), others.end()), 0.99);
    const auto dark = std::ranges::count_if(others, [&](float v) { return v - next < kDark * (bright - next); });
    if (static_cast<double>(dark) < kLeastAir * static_cast<double>(others.size()) || bright <= next) return;
    std::ranges::replace(volume.values, least, next);
    volume.notes.push_back(fmt::format(
        "its voxels of exactly {:.0f} are no air of a CT, for nothing else lies below {:.0f}: they were taken "
        "for the padding of an MR",
        least, next));
}

/// True of values that are those of a CT with 1024 (or 1000) added: none is below zero, more than half of what is no
/// air lies between fat and blood, little between air and fat, and some of it is bone. Of 19 volumes of MR none fits,
/// scaled as suits it best.
bool is_ct_above_zero(const std::vector<float>& sample) {
    constexpr double kAir = 150, kFat = 900, kBlood = 1150, kDenserThanAir = 850, kBone = 1250, kMetal = 3200;
    if (*std::ranges::min_element(sample) < -100) return false;
    const double all = percent_from(sample, kAir);
    if (all <= 0 || all > 90) return false;
    const auto share = [&](double from, double to) {
        return (percent_from(sample, from) - percent_from(sample, to)) / all;
    };
    return share(kFat, kBlood) > 0.55 && share(kAir, kDenserThanAir) < 0.3 && share(kBone, 1e9) > 0.03 &&
           share(kMetal, 1e9) < 0.02;
}

}  // namespace

void check_grid(const Volume& volume, const fs::path& file, double tolerance) {
    const Eigen::Matrix3d axes = volume.ct_from_voxel.linear();
    if (!volume.ct_from_voxel.matrix().allFinite())
        throw InputError(file, "has a geometry with a value that is not a number", kExportAgain);
    for (int a = 0; a < 3; ++a) {
        const double spacing = axes.col(a).norm();
        const int count = volume.size[static_cast<std::size_t>(a)];
        if (!(spacing > 0.01) || !(spacing < 20))
            throw InputError(file, fmt::format("has a spacing of {:.4g} mm along axis {}", spacing, a + 1),
                             "Check its units, or export it again.");
        if (count < kFewestSlices)
            throw InputError(
                file, fmt::format("has {} along axis {}, fewer than {}", counted(count, "slice"), a + 1, kFewestSlices),
                "Give the whole series of thin slices.");
        if (spacing * count < kShortest_mm || spacing * count > kLongest_mm)
            throw InputError(file,
                             fmt::format("is {:.4g} mm long along axis {}, which is no head", spacing * count, a + 1),
                             "Check its units, or export it again.");
        for (int b = 0; b < a; ++b) {
            const double cosine = std::abs(axes.col(a).normalized().dot(axes.col(b).normalized()));
            if (cosine > tolerance)
                throw InputError(file,
                                 fmt::format("has axes {} and {} that are not perpendicular (the cosine between them "
                                             "is {:.2g}, at most {} is right)",
                                             b + 1, a + 1, cosine, tolerance),
                                 "Give the DICOM series, or resample the volume to perpendicular axes.");
        }
    }
    if (volume.ct_from_voxel.translation().cwiseAbs().maxCoeff() > kMostMagnitude_mm)
        throw InputError(
            file,
            fmt::format("begins {:.0f} mm from the origin of its frame", volume.ct_from_voxel.translation().norm()),
            "Check its units and its origin.");
}

void make_right_handed(Volume& volume) {
    if (volume.ct_from_voxel.linear().determinant() > 0) return;
    const auto slab = static_cast<std::ptrdiff_t>(volume.index(0, 0, 1));
    const int last = volume.size[2] - 1;
    for (int k = 0; k < last - k; ++k) {
        const auto low = volume.values.begin() + k * slab;
        std::swap_ranges(low, low + slab, volume.values.begin() + (last - k) * slab);
    }
    volume.ct_from_voxel.translation() += last * volume.ct_from_voxel.linear().col(2);
    volume.ct_from_voxel.linear().col(2) *= -1;
}

bool has_air_in_hu(const Volume& volume, const std::vector<char>& left_out) {
    std::size_t air = 0, asked = 0;
    for (std::size_t i = 0; i < volume.values.size(); ++i) {
        if (!left_out.empty() && left_out[i]) continue;
        ++asked;
        air += volume.values[i] <= kAirBelow_hu;
    }
    return static_cast<double>(air) >= kLeastAirShare * static_cast<double>(asked) && air > 0;
}

void tell_modality_by_values(Volume& volume) {
    fill_padding(volume);
    if (is_ct_above_zero(sample_of(volume))) {
        for (float& v : volume.values) v -= 1024;
        volume.is_hu = true;
        volume.modality = "CT";
        volume.notes.push_back(
            "the file does not say whether it is CT or MR: taken for a CT to whose HU 1024 was added (its air lies at "
            "0 "
            "or above, and most of the rest near 1024), which was taken off again");
        return;
    }
    const float least = *std::min_element(volume.values.begin(), volume.values.end());
    const bool has_air = has_air_in_hu(volume);
    // An MR from which 1024 was taken has air like that of HU, and hardly anything denser.
    volume.is_hu = has_air && percent_from(sample_of(volume), kDenserThanAir_hu) >= kLeastBody_percent;
    volume.modality = volume.is_hu ? "CT" : "MR";
    const char* const why = has_air && !volume.is_hu ? "hardly anything in it is denser than the air of a CT in HU"
                                                     : "the air of a CT in HU near -1000";
    volume.notes.push_back(
        fmt::format("the file does not say whether it is CT or MR: taken for {} (its least value is {:.0f}, and {})",
                    volume.modality, least, why));
}

void check_for_skin(const Volume& volume, const fs::path& file) {
    const auto refuse = [&](const std::string& what) {
        throw InputError(file, "has no skin in it: " + what, "Give a volume of the head with air around it.");
    };
    const std::vector<float> sample = sample_of(volume);
    const auto [low, high] = std::minmax_element(sample.begin(), sample.end());
    if (sample.empty() || *low == *high) refuse(fmt::format("every voxel is {:.0f}", sample.empty() ? 0 : *low));
    const double level = air_level(volume, sample, *low, *high);
    const double share = percent_from(sample, level);
    if (share < kLeastBody_percent)
        refuse(fmt::format("only {:.2f} % of the voxels are denser than air ({:.0f})", share, level));
    if (share > 100 - kLeastBody_percent)
        refuse(fmt::format("only {:.2f} % of the voxels are air (below {:.0f})", 100 - share, level));
    if (sides_with_air(volume, level) == 0)
        refuse(fmt::format("the body fills the volume to all six sides ({:.0f} % of it is denser than {:.0f})", share,
                           level));
}

}  // namespace planlight
