#include "projection/dark_discs.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace planlight {

using Eigen::Vector2d;
using Eigen::Vector3d;

std::vector<DarkDisc> dark_discs(const CameraModel& projector, const RigidTransform& rig_from_patient,
                                 const RenderSettings& s) {
    std::vector<DarkDisc> discs;
    const double radius_mm = s.keep_dark_radius_mm + s.halo_mm;
    for (const Vector3d& marker : s.keep_dark_in_patient) {
        const Vector3d p = rig_from_patient * marker;
        Eigen::Matrix<double, 2, 3> pixel_by_rig;
        const auto centre = project(projector, p, pixel_by_rig);
        if (!centre) continue;
        const Vector3d towards = (projector.centre_in_rig() - p).normalized(), first = towards.unitOrthogonal();
        Eigen::Matrix2d pixel_by_disc;
        pixel_by_disc << pixel_by_rig * first * radius_mm, pixel_by_rig * towards.cross(first) * radius_mm;
        const DarkDisc disc{*centre, pixel_by_disc.inverse(), pixel_by_disc.norm() + 1};
        if (disc.disc_by_pixel.allFinite() && centre->norm() + disc.reach < 1e6) discs.push_back(disc);
    }
    return discs;
}

void darken(const std::vector<DarkDisc>& discs, RgbImage& picture) {
    for (const DarkDisc& disc : discs) {
        const int x0 = std::max(0, static_cast<int>(disc.centre.x() - disc.reach)),
                  x1 = std::min(picture.width - 1, static_cast<int>(disc.centre.x() + disc.reach) + 1);
        const int y0 = std::max(0, static_cast<int>(disc.centre.y() - disc.reach)),
                  y1 = std::min(picture.height - 1, static_cast<int>(disc.centre.y() + disc.reach) + 1);
        for (int y = y0; y <= y1; ++y)
            for (int x = x0; x <= x1; ++x)
                if (disc.covers(Vector2d(x, y))) picture.at(x, y) = {0, 0, 0};
    }
}

}  // namespace planlight
