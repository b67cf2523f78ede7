#include "tests/registration/matching/head_heights.h"

#include <algorithm>

namespace planlight::test {

using Eigen::Vector3d;

HeadHeights::HeadHeights(const TrialSurface& head, const ViewFrame& view) : z_(kSide * kSide, kNothing_mm) {
    for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i) {
            const Vector3d from(i * kCell_mm - kWidth_mm / 2, j * kCell_mm - kWidth_mm / 2, 400);
            const auto hit = head.first_hit(view.to_ct(from), -view.ct_from_view.linear().col(2));
            if (hit) at(i, j) = (view.ct_from_view.inverse() * hit->p_in_ct).z();
        }
}

HeadHeights HeadHeights::covered(double floor_mm, double radius_mm) const {
    HeadHeights result = *this;
    for (double& z : result.z_) z = std::max(z, floor_mm);
    result.take(radius_mm, true);
    result.take(radius_mm, false);
    for (int pass = 0; pass < 3; ++pass) result.smooth();
    for (std::size_t i = 0; i < z_.size(); ++i) result.z_[i] = std::max(result.z_[i], z_[i]);
    return result;
}

double HeadHeights::operator()(double x, double y) const {
    const double u = std::clamp((x + kWidth_mm / 2) / kCell_mm, 0., kSide - 1.001),
                 v = std::clamp((y + kWidth_mm / 2) / kCell_mm, 0., kSide - 1.001);
    const int i = static_cast<int>(u), j = static_cast<int>(v);
    const double a = u - i, b = v - j;
    return (1 - b) * ((1 - a) * at(i, j) + a * at(i + 1, j)) + b * ((1 - a) * at(i, j + 1) + a * at(i + 1, j + 1));
}

void HeadHeights::take(double radius_mm, bool highest) {
    const int r = static_cast<int>(radius_mm / kCell_mm);
    const std::vector<double> old = z_;
    for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i)
            for (int dj = -r; dj <= r; ++dj)
                for (int di = -r; di <= r; ++di) {
                    const int k = i + di, l = j + dj;
                    if (di * di + dj * dj > r * r || k < 0 || l < 0 || k >= kSide || l >= kSide) continue;
                    const double z = old[static_cast<std::size_t>(l * kSide + k)];
                    at(i, j) = highest ? std::max(at(i, j), z) : std::min(at(i, j), z);
                }
}

void HeadHeights::smooth() {
    const std::vector<double> old = z_;
    for (int j = 1; j + 1 < kSide; ++j)
        for (int i = 1; i + 1 < kSide; ++i) {
            double sum = 0;
            for (int dj = -1; dj <= 1; ++dj)
                for (int di = -1; di <= 1; ++di) sum += old[static_cast<std::size_t>((j + dj) * kSide + i + di)];
            at(i, j) = sum / 9;
        }
}

}  // namespace planlight::test
