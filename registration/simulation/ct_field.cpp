#include "registration/simulation/ct_field.h"

#include <algorithm>
#include <stdexcept>

#include "registration/simulation/isolate_head.h"

namespace planlight::simulation {

namespace {
constexpr int kPad = 2;  ///< voxels of air round the volume
}

CtField::CtField(const Volume& volume, double threshold) {
    const auto count = static_cast<std::size_t>(volume.size[0]) * static_cast<std::size_t>(volume.size[1]) *
                       static_cast<std::size_t>(volume.size[2]);
    if (count == 0 || volume.values.size() != count) throw std::invalid_argument("the volume holds no voxels");
    const auto head = head_voxels(volume, threshold);
    if (head.empty()) throw std::invalid_argument("no head surface is in the volume at this threshold");
    const auto near_head = grown(head, volume.size, {3, 3, 3});
    const double least = *std::min_element(volume.values.begin(), volume.values.end());
    air_ = std::clamp(least - threshold, -1000.0, -1.0);
    for (int a = 0; a < 3; ++a)
        size_[static_cast<std::size_t>(a)] = volume.size[static_cast<std::size_t>(a)] + 2 * kPad;
    ct_from_voxel_ = volume.ct_from_voxel * Eigen::Translation3d(-kPad, -kPad, -kPad);
    voxel_from_ct_ = ct_from_voxel_.inverse();
    values_.assign(index(0, 0, size_[2]), static_cast<float>(air_));
    for (int k = 0; k < volume.size[2]; ++k)
        for (int j = 0; j < volume.size[1]; ++j)
            for (int i = 0; i < volume.size[0]; ++i) {
                const std::size_t v = volume.index(i, j, k);
                const bool other_body = volume.values[v] > threshold && !head[v];
                if (near_head[v] && !other_body)
                    values_[index(i + kPad, j + kPad, k + kPad)] =
                        static_cast<float>(static_cast<double>(volume.values[v]) - threshold);
            }
    smooth();
    find_room_air();
}

void CtField::smooth() {
    smoothed_ = values_;
    const std::array<std::size_t, 3> stride{1, static_cast<std::size_t>(size_[0]), index(0, 0, 1)};
    std::vector<float> before;
    for (int pass = 0; pass < 2; ++pass)  // binomial 1 4 6 4 1: about one voxel of sigma
        for (const std::size_t step : stride) {
            before = smoothed_;
            for (std::size_t v = step; v + step < before.size(); ++v)
                smoothed_[v] = 0.25F * before[v - step] + 0.5F * before[v] + 0.25F * before[v + step];
        }
}

void CtField::find_room_air() {
    room_air_.assign(values_.size(), 0);
    std::vector<std::size_t> front{0};
    room_air_[0] = 1;
    const std::array<std::size_t, 3> stride{1, static_cast<std::size_t>(size_[0]), index(0, 0, 1)};
    const auto enter = [&](std::size_t v) {
        if (room_air_[v] || values_[v] > 0) return;
        room_air_[v] = 1;
        front.push_back(v);
    };
    while (!front.empty()) {
        const std::size_t v = front.back();
        front.pop_back();
        for (const std::size_t step : stride) {  // wrapping round a row end lands in the air of the padding
            if (v >= step) enter(v - step);
            if (v + step < values_.size()) enter(v + step);
        }
    }
}

bool CtField::next_to_room_air(const Eigen::Vector3d& p_in_ct) const {
    const Eigen::Vector3i v = (voxel_from_ct_ * p_in_ct).array().floor().cast<int>();
    for (int corner = 0; corner < 8; ++corner) {
        const int i = v.x() + (corner & 1), j = v.y() + ((corner >> 1) & 1), k = v.z() + (corner >> 2);
        if (i < 0 || j < 0 || k < 0 || i >= size_[0] || j >= size_[1] || k >= size_[2]) return true;
        if (room_air_[index(i, j, k)]) return true;
    }
    return false;
}

Eigen::Vector3d CtField::gradient(const Eigen::Vector3d& p_in_ct) const {
    constexpr double kStep = 1e-3;  // voxels; the field is linear along an axis inside a cell
    const Eigen::Vector3d q = voxel_from_ct_ * p_in_ct;
    Eigen::Vector3d g;
    for (int a = 0; a < 3; ++a) {
        const Eigen::Vector3d h = kStep * Eigen::Vector3d::Unit(a);
        g[a] = (sample(values_, q + h) - sample(values_, q - h)) / (2 * kStep);
    }
    return voxel_from_ct_.linear().transpose() * g;
}

Eigen::Vector3d CtField::smooth_gradient(const Eigen::Vector3d& p_in_ct) const {
    const Eigen::Vector3d q = voxel_from_ct_ * p_in_ct;
    Eigen::Vector3d g;
    for (int a = 0; a < 3; ++a) {
        const Eigen::Vector3d h = 0.7 * Eigen::Vector3d::Unit(a);
        g[a] = (sample(smoothed_, q + h) - sample(smoothed_, q - h)) / 1.4;
    }
    return voxel_from_ct_.linear().transpose() * g;
}

}  // namespace planlight::simulation
