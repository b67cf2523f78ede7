#include "registration/simulation/board_sheet.h"

#include <cmath>

namespace planlight::simulation {

using Eigen::Vector2d;
using Eigen::Vector3d;

BoardSheet white_card() {
    BoardSheet sheet;
    sheet.px_per_mm = 2;
    sheet.print = GrayImage(420, 594, 255);
    return sheet;
}

double BoardSheet::z_at(double x, double y, Vector2d* slope) const {
    if (sag_mm == 0) {
        if (slope) slope->setZero();
        return 0;
    }
    const Vector2d across(std::cos(bend_direction), std::sin(bend_direction));
    const double half = std::hypot(width_mm(), height_mm()) / 2;
    const double s = across.dot(Vector2d(x - width_mm() / 2, y - height_mm() / 2)) / half;
    if (slope) *slope = across * (2 * sag_mm * s / half);
    return sag_mm * (s * s - 1);
}

std::optional<Surface::Hit> SheetSurface::first_hit(const Vector3d& origin, const Vector3d& direction) const {
    if (direction.z() <= 1e-3) return std::nullopt;  // from behind, or along the sheet
    double t = -origin.z() / direction.z();
    Vector2d slope;
    for (int i = 0; i < 6; ++i) {
        const Vector3d p = origin + t * direction;
        const double off = p.z() - sheet_.z_at(p.x(), p.y(), &slope);
        t -= off / (direction.z() - slope.dot(direction.head<2>()));
        if (std::abs(off) < 1e-9) break;
    }
    const Vector3d p = origin + t * direction;
    const double m = sheet_.margin_mm;
    if (t <= 0 || p.x() < -m || p.y() < -m || p.x() > sheet_.width_mm() + m || p.y() > sheet_.height_mm() + m)
        return std::nullopt;
    sheet_.z_at(p.x(), p.y(), &slope);
    return Hit{p, Vector3d(slope.x(), slope.y(), -1).normalized(), t};
}

Vector3d SheetSurface::low_in_ct() const {
    return {-sheet_.margin_mm, -sheet_.margin_mm, -std::abs(sheet_.sag_mm) - 1};
}

Vector3d SheetSurface::high_in_ct() const {
    return {sheet_.width_mm() + sheet_.margin_mm, sheet_.height_mm() + sheet_.margin_mm, std::abs(sheet_.sag_mm) + 1};
}

Look SheetLook::at(const Vector3d& p) const {
    const int x = static_cast<int>(std::floor(p.x() * sheet_.px_per_mm)),
              y = static_cast<int>(std::floor(p.y() * sheet_.px_per_mm));
    const bool printed = x >= 0 && y >= 0 && x < sheet_.print.width && y < sheet_.print.height;
    const std::uint8_t value = printed ? sheet_.print.at(x, y) : std::uint8_t{255};
    return {value > 200 ? Material::paper : Material::ink, kPaperAlbedo * value / 255, 0.002, 0};
}

}  // namespace planlight::simulation
