#include "registration/matching/cloud_region.h"

namespace planlight {
namespace {

using Eigen::Vector2d;

bool within(const std::vector<Vector2d>& outline, const Vector2d& at) {
    bool inside = false;
    for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++) {
        const Vector2d &a = outline[i], &b = outline[j];
        if ((a.y() > at.y()) == (b.y() > at.y())) continue;
        inside ^= at.x() < a.x() + (b.x() - a.x()) * (at.y() - a.y()) / (b.y() - a.y());
    }
    return inside;
}

}  // namespace

PointCloud within_outline(const PointCloud& cloud, const CameraModel& camera, std::vector<Vector2d> outline) {
    if (outline.size() == 2) {
        const Vector2d a = outline[0], b = outline[1];
        outline = {a, {b.x(), a.y()}, b, {a.x(), b.y()}};
    }
    PointCloud part;
    if (outline.size() < 3) return part;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const auto pixel = project(camera, cloud.points_in_rig[i]);
        if (!pixel || !within(outline, *pixel)) continue;
        part.points_in_rig.push_back(cloud.points_in_rig[i]);
        if (!cloud.normals_in_rig.empty()) part.normals_in_rig.push_back(cloud.normals_in_rig[i]);
        if (!cloud.sigma_mm.empty()) part.sigma_mm.push_back(cloud.sigma_mm[i]);
        if (!cloud.pixels_in_projector.empty()) part.pixels_in_projector.push_back(cloud.pixels_in_projector[i]);
    }
    return part;
}

}  // namespace planlight
