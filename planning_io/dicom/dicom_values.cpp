#include "planning_io/dicom/dicom_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "planning_io/volume/fill_corners.h"
#include "planning_io/volume/volume_checks.h"

namespace planlight {
namespace {

constexpr float kAir_hu = -1000, kLeast_hu = -1024;

/// Marks of all slices' padding, of the stored values; empty when there is none.
std::vector<char> padding_of(const Volume& volume, const std::vector<SliceValues>& slices) {
    const std::size_t slab = volume.index(0, 0, 1);
    std::vector<char> marks;
    if (std::none_of(slices.begin(), slices.end(), [](const SliceValues& s) { return s.has_padding; })) return marks;
    for (std::size_t k = 0; k < slices.size(); ++k) {
        if (!slices[k].has_padding) {
            marks.resize((k + 1) * slab, 0);
            continue;
        }
        const float* stored = volume.values.data() + k * slab;
        const auto low = static_cast<float>(slices[k].padding), high = static_cast<float>(slices[k].padding_limit);
        const auto of_slice = joined_to_edge(volume.size[0], volume.size[1],
                                             [&](std::size_t at) { return stored[at] >= low && stored[at] <= high; });
        marks.insert(marks.end(), of_slice.begin(), of_slice.end());
    }
    return marks;
}

float least_of(const Volume& volume, const std::vector<char>& padding) {
    float least = std::numeric_limits<float>::max();
    for (std::size_t i = 0; i < volume.values.size(); ++i)
        if (padding.empty() || !padding[i]) least = std::min(least, volume.values[i]);
    return least;
}

/// Slope 1, intercept 0 and nothing below zero in a CT: stored values without their unit, not HU; nor is a CT without
/// air.
bool values_are_hu(const Volume& volume, const std::vector<char>& padding, float least,
                   const std::vector<SliceValues>& slices, const std::string& rescale_type) {
    if (volume.modality != "CT" || (!rescale_type.empty() && rescale_type != "HU")) return false;
    const bool offset =
        std::any_of(slices.begin(), slices.end(), [](const SliceValues& s) { return s.intercept != 0; });
    return (offset || least < 0) && has_air_in_hu(volume, padding);
}

}  // namespace

void rescale(Volume& volume, const std::vector<SliceValues>& slices, const std::string& rescale_type,
             bool has_rescale) {
    const std::vector<char> padding = padding_of(volume, slices);
    const std::size_t slab = volume.index(0, 0, 1);
    for (std::size_t k = 0; k < slices.size(); ++k)
        for (std::size_t i = k * slab; i < (k + 1) * slab; ++i)
            volume.values[i] = static_cast<float>(volume.values[i] * slices[k].slope + slices[k].intercept);
    const float least = least_of(volume, padding);
    volume.is_hu = values_are_hu(volume, padding, least, slices, rescale_type);
    const auto padded = std::count(padding.begin(), padding.end(), 1);
    for (std::size_t i = 0; i < padding.size(); ++i)
        if (padding[i]) volume.values[i] = volume.is_hu ? kAir_hu : least;
    if (padded > 0) volume.notes.push_back(fmt::format("{} voxels of padding were made air", padded));
    if (volume.modality == "CT" && !has_rescale)
        volume.notes.push_back("the CT has no rescale slope and intercept: 1 and 0 are used");
    if (!volume.is_hu) return;
    for (float& v : volume.values)
        if (v < kLeast_hu) v = kLeast_hu;
    fill_corners(volume);
}

}  // namespace planlight
