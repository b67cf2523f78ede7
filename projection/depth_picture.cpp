#include "projection/depth_picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr int kBlock_px = 8;
constexpr double kCell_mm = 4;  // vertices within a cell become one (Rossignac & Borrel 1993)
constexpr float kFar = 0;       // of one over the depth
constexpr double kTolerance_mm = 4;

}  // namespace

DepthPicture::DepthPicture(const TriangleMesh& mesh) {
    std::unordered_map<std::int64_t, std::int32_t> vertex_of_cell;
    std::vector<std::int32_t> new_index(mesh.vertices_in_ct.size());
    std::vector<int> members;
    for (std::size_t i = 0; i < mesh.vertices_in_ct.size(); ++i) {
        const Eigen::Vector3i cell = (mesh.vertices_in_ct[i] / kCell_mm).array().floor().cast<int>();
        const std::int64_t key = (static_cast<std::int64_t>(cell.x()) * 2097169 + cell.y()) * 2097169 + cell.z();
        const auto [entry, fresh] = vertex_of_cell.emplace(key, static_cast<std::int32_t>(vertices_in_ct_.size()));
        if (fresh) {
            vertices_in_ct_.push_back(Vector3d::Zero());
            members.push_back(0);
        }
        new_index[i] = entry->second;
        vertices_in_ct_[static_cast<std::size_t>(entry->second)] += mesh.vertices_in_ct[i];
        ++members[static_cast<std::size_t>(entry->second)];
    }
    for (std::size_t i = 0; i < members.size(); ++i) vertices_in_ct_[i] /= members[i];
    for (const auto& t : mesh.triangles) {
        const auto a = new_index[static_cast<std::size_t>(t[0])], b = new_index[static_cast<std::size_t>(t[1])],
                   c = new_index[static_cast<std::size_t>(t[2])];
        if (a != b && b != c && c != a) triangles_.push_back({a, b, c});
    }
    seen_.resize(vertices_in_ct_.size());
}

void DepthPicture::draw(const CameraModel& projector_from_ct) {
    width_ = (projector_from_ct.width + kBlock_px - 1) / kBlock_px;
    height_ = (projector_from_ct.height + kBlock_px - 1) / kBlock_px;
    inverse_depth_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), kFar);
    for (std::size_t i = 0; i < vertices_in_ct_.size(); ++i) {
        const auto pixel = project(projector_from_ct, vertices_in_ct_[i]);
        if (!pixel) {
            seen_[i] = Vector3d::Zero();
            continue;
        }
        const double depth = (projector_from_ct.device_from_rig * vertices_in_ct_[i]).z();
        seen_[i] << (pixel->x() + 0.5) / kBlock_px - 0.5, (pixel->y() + 0.5) / kBlock_px - 0.5, 1 / depth;
    }
    for (const auto& t : triangles_) {
        const Vector3d &p = seen_[static_cast<std::size_t>(t[0])], &q = seen_[static_cast<std::size_t>(t[1])],
                       &r = seen_[static_cast<std::size_t>(t[2])];
        if (p.z() > 0 && q.z() > 0 && r.z() > 0) draw_triangle(p, q, r);
    }
}

/// One over the depth is linear in the picture, and so are the shares of the corners q and r.
void DepthPicture::draw_triangle(const Vector3d& p, const Vector3d& q, const Vector3d& r) {
    const int x0 = static_cast<int>(std::ceil(std::max(0.0, std::min({p.x(), q.x(), r.x()})))),
              x1 = static_cast<int>(std::floor(std::min(width_ - 1.0, std::max({p.x(), q.x(), r.x()}))));
    const int y0 = static_cast<int>(std::ceil(std::max(0.0, std::min({p.y(), q.y(), r.y()})))),
              y1 = static_cast<int>(std::floor(std::min(height_ - 1.0, std::max({p.y(), q.y(), r.y()}))));
    if (x0 > x1 || y0 > y1) return;
    const Vector3d to_q = q - p, to_r = r - p;
    const double area = to_q.x() * to_r.y() - to_q.y() * to_r.x();
    if (std::abs(area) < 1e-12) return;
    const double q_by_x = to_r.y() / area, q_by_y = -to_r.x() / area, r_by_x = -to_q.y() / area,
                 r_by_y = to_q.x() / area;
    constexpr double kRim = 1e-9;
    for (int y = y0; y <= y1; ++y) {
        float* row = inverse_depth_.data() + static_cast<std::ptrdiff_t>(y) * width_;
        const double q_of_row = (y - p.y()) * q_by_y, r_of_row = (y - p.y()) * r_by_y;
        for (int x = x0; x <= x1; ++x) {
            const double of_q = q_of_row + (x - p.x()) * q_by_x, of_r = r_of_row + (x - p.x()) * r_by_x;
            if (of_q < -kRim || of_r < -kRim || of_q + of_r > 1 + kRim) continue;
            row[x] = std::max(row[x], static_cast<float>(p.z() + of_q * to_q.z() + of_r * to_r.z()));
        }
    }
}

DepthPicture::Answer DepthPicture::ask(const Eigen::Vector2d& pixel, double depth_mm) const {
    const int column = static_cast<int>(std::floor((pixel.x() + 0.5) / kBlock_px));
    const int row = static_cast<int>(std::floor((pixel.y() + 0.5) / kBlock_px));
    float nearest = kFar, farthest = std::numeric_limits<float>::infinity();  // one over the depth
    for (int y = row - 1; y <= row + 1; ++y)
        for (int x = column - 1; x <= column + 1; ++x) {
            if (x < 0 || y < 0 || x >= width_ || y >= height_) continue;
            const float there = inverse_depth_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                                               static_cast<std::size_t>(x)];
            nearest = std::max(nearest, there);
            farthest = std::min(farthest, there);
        }
    const bool at_border = column < 1 || row < 1 || column >= width_ - 1 || row >= height_ - 1;
    if (at_border) return Answer::near_an_edge;
    if (nearest * (depth_mm - kTolerance_mm) < 1) return Answer::lit;
    if (farthest * (depth_mm - 2 * kTolerance_mm) > 1) return Answer::hidden;
    return Answer::near_an_edge;
}

}  // namespace planlight
