#include "segmentation/skin_field.h"

#include <algorithm>
#include <cmath>

namespace planlight {
namespace {

/// How far air lies below the threshold, in the volume's unit.
double contrast_of(const Volume& volume, const SkinMask& mask) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < mask.body.size(); i += 7) {
        const double below = mask.threshold - static_cast<double>(volume.values[i]);
        if (mask.body[i] || !(below > 0)) continue;
        sum += below;
        ++count;
    }
    return count > 0 ? sum / count : 1;
}

float off_threshold(double value, bool inside, double threshold, double contrast) {
    const double least = 1e-3 * contrast;  // keeps crossings off the voxel centres: no triangle without area
    return static_cast<float>(inside ? std::max(value, threshold + least) : std::min(value, threshold - least));
}

}  // namespace

SkinField skin_field(const Volume& volume, const SkinMask& mask) {
    SkinField field;
    for (std::size_t a = 0; a < 3; ++a) field.size[a] = volume.size[a] + 2;
    field.threshold = static_cast<float>(mask.threshold);
    field.values.resize(static_cast<std::size_t>(field.size[0]) * static_cast<std::size_t>(field.size[1]) *
                        static_cast<std::size_t>(field.size[2]));
    const double t = mask.threshold, contrast = contrast_of(volume, mask);
    const auto inner = [&](int i, int j, int k) {
        const std::size_t v = volume.index(i, j, k);
        const bool body = mask.body[v];
        const bool dense = volume.values[v] >= field.threshold;
        const double value = std::isfinite(volume.values[v]) ? static_cast<double>(volume.values[v]) : t - contrast;
        return off_threshold(body == dense ? value : body ? t + contrast : t - contrast, body, t, contrast);
    };
    std::size_t at = 0;
    for (int k = -1; k <= volume.size[2]; ++k)
        for (int j = -1; j <= volume.size[1]; ++j)
            for (int i = -1; i <= volume.size[0]; ++i, ++at) {
                const int ci = std::clamp(i, 0, volume.size[0] - 1), cj = std::clamp(j, 0, volume.size[1] - 1),
                          ck = std::clamp(k, 0, volume.size[2] - 1);
                const double value = inner(ci, cj, ck);
                const bool padding = ci != i || cj != j || ck != k;
                field.values[at] = static_cast<float>(padding ? std::min(value, 2 * t - value) : value);
            }
    return field;
}

std::uint8_t flag_of_edge(const Volume& volume, const SkinMask& mask, const Eigen::Vector3i& a,
                          const Eigen::Vector3i& b) {
    std::uint8_t flag = kSkin;
    for (const Eigen::Vector3i& end : {a, b}) {
        const Eigen::Vector3i v = end - Eigen::Vector3i::Ones();
        for (int axis = 0; axis < 3; ++axis)
            if (v[axis] < 0 || v[axis] >= volume.size[static_cast<std::size_t>(axis)]) return kCutPlane;
        const std::size_t index = volume.index(v.x(), v.y(), v.z());
        if (!mask.body[index] && std::isnan(volume.values[index])) return kCutPlane;  // nothing was measured there
        if ((mask.body[index] != 0) != (volume.values[index] >= static_cast<float>(mask.threshold))) flag = kSeal;
    }
    return flag;
}

Eigen::Vector3d gradient(const SkinField& field, const Eigen::Vector3d& at) {
    const Eigen::Vector3i cell = at.array().floor().cast<int>();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int corner = 0; corner < 8; ++corner) {
        Eigen::Vector3i v = cell;
        double weight = 1;
        for (int axis = 0; axis < 3; ++axis) {
            const int up = (corner >> axis) & 1;
            v[axis] += up;
            const double f = at[axis] - cell[axis];
            weight *= up ? f : 1 - f;
        }
        if (weight <= 0) continue;
        for (int axis = 0; axis < 3; ++axis) {
            Eigen::Vector3i low = v, high = v;
            const int last = field.size[static_cast<std::size_t>(axis)] - 1;
            low[axis] = std::max(v[axis] - 1, 0);
            high[axis] = std::min(v[axis] + 1, last);
            const auto rise =
                static_cast<double>(field.at(high.x(), high.y(), high.z()) - field.at(low.x(), low.y(), low.z()));
            sum[axis] += weight * rise / std::max(1, high[axis] - low[axis]);
        }
    }
    return sum;
}

}  // namespace planlight
