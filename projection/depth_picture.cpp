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
constexpr float kFar = std::numeric_limits<float>::infinity();
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
    depth_mm_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), kFar);
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
        const std::array<Vector3d, 3> corners{seen_[static_cast<std::size_t>(t[0])],
                                              seen_[static_cast<std::size_t>(t[1])],
                                              seen_[static_cast<std::size_t>(t[2])]};
        if (corners[0].z() > 0 && corners[1].z() > 0 && corners[2].z() > 0) draw_triangle(corners);
    }
}

void DepthPicture::draw_triangle(const std::array<Vector3d, 3>& p) {
    const double area = (p[1].x() - p[0].x()) * (p[2].y() - p[0].y()) - (p[1].y() - p[0].y()) * (p[2].x() - p[0].x());
    if (std::abs(area) < 1e-12) return;
    const auto [low_x, high_x] = std::minmax({p[0].x(), p[1].x(), p[2].x()});
    const auto [low_y, high_y] = std::minmax({p[0].y(), p[1].y(), p[2].y()});
    const int x0 = static_cast<int>(std::ceil(std::max(0.0, low_x))),
              x1 = static_cast<int>(std::floor(std::min(width_ - 1.0, high_x)));
    const int y0 = static_cast<int>(std::ceil(std::max(0.0, low_y))),
              y1 = static_cast<int>(std::floor(std::min(height_ - 1.0, high_y)));
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            const double b = ((x - p[0].x()) * (p[2].y() - p[0].y()) - (y - p[0].y()) * (p[2].x() - p[0].x())) / area;
            const double c = ((p[1].x() - p[0].x()) * (y - p[0].y()) - (p[1].y() - p[0].y()) * (x - p[0].x())) / area;
            if (b < -1e-9 || c < -1e-9 || b + c > 1 + 1e-9) continue;
            const double inverse_depth = (1 - b - c) * p[0].z() + b * p[1].z() + c * p[2].z();
            float& depth =
                depth_mm_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)];
            depth = std::min(depth, static_cast<float>(1 / inverse_depth));
        }
}

DepthPicture::Answer DepthPicture::ask(const Eigen::Vector2d& pixel, double depth_mm) const {
    const int column = static_cast<int>(std::floor((pixel.x() + 0.5) / kBlock_px));
    const int row = static_cast<int>(std::floor((pixel.y() + 0.5) / kBlock_px));
    float nearest = kFar, farthest = 0;
    for (int y = row - 1; y <= row + 1; ++y)
        for (int x = column - 1; x <= column + 1; ++x) {
            if (x < 0 || y < 0 || x >= width_ || y >= height_) continue;
            const float depth =
                depth_mm_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)];
            nearest = std::min(nearest, depth);
            farthest = std::max(farthest, depth);
        }
    const bool at_border = column < 1 || row < 1 || column >= width_ - 1 || row >= height_ - 1;
    if (at_border) return Answer::near_an_edge;
    if (nearest > depth_mm - kTolerance_mm) return Answer::lit;
    if (farthest < depth_mm - 2 * kTolerance_mm) return Answer::hidden;
    return Answer::near_an_edge;
}

}  // namespace planlight
