#include "planning_io/types/between_rays.h"

namespace planlight {

std::optional<Eigen::Vector3d> between_rays(const Ray& a, const Ray& b) {
    const Eigen::Vector3d w = b.origin - a.origin;
    const double cosine = a.direction.dot(b.direction), sine2 = 1 - cosine * cosine;
    if (sine2 < 1e-6) return std::nullopt;
    const double along_a = (w.dot(a.direction) - cosine * w.dot(b.direction)) / sine2;
    const double along_b = (cosine * w.dot(a.direction) - w.dot(b.direction)) / sine2;
    if (along_a <= 0 || along_b <= 0) return std::nullopt;
    return 0.5 * (a.origin + along_a * a.direction + b.origin + along_b * b.direction);
}

}  // namespace planlight
