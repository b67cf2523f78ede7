#include "tests/segmentation/head_sheet.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "planning_io/volume/volume_sample.h"

namespace planlight::test {
namespace {

using Eigen::Vector3d;

constexpr int kTile = 260;

/// A look along `forward`, `right` and `down` on the picture.
struct View {
    Vector3d right, down, forward;
};

struct Frame {
    Vector3d middle;
    double mm_per_pixel = 1;
};

Rgb shade(double light, std::uint8_t flag) {
    const double l = 40 + 200 * std::clamp(light, 0.0, 1.0);
    const auto c = [](double v) { return static_cast<std::uint8_t>(std::clamp(v, 0.0, 255.0)); };
    if (flag == kCutPlane) return {c(l), c(0.35 * l), c(0.3 * l)};
    if (flag == kSeal) return {c(0.3 * l), c(0.5 * l), c(l)};
    return {c(l), c(0.85 * l), c(0.74 * l)};
}

constexpr Rgb kMark{255, 235, 40};
constexpr double kNearMark_mm = 8;  // a mark that lies no deeper than this under the surface is seen

void draw_view(RgbImage& sheet, int x0, int y0, const TriangleMesh& skin, const std::vector<Vector3d>& marks,
               const View& view, const Frame& frame) {
    std::vector<double> depth(static_cast<std::size_t>(kTile) * kTile, 1e9);
    for (const auto& t : skin.triangles) {
        std::array<Vector3d, 3> p;
        std::uint8_t flag = kSkin;
        for (std::size_t c = 0; c < 3; ++c) {
            const auto v = static_cast<std::size_t>(t[c]);
            const Vector3d at = skin.vertices_in_ct[v] - frame.middle;
            p[c] = {kTile / 2.0 + at.dot(view.right) / frame.mm_per_pixel,
                    kTile / 2.0 + at.dot(view.down) / frame.mm_per_pixel, at.dot(view.forward)};
            if (!skin.flags.empty()) flag = std::max(flag, skin.flags[v]);
        }
        const Vector3d normal =
            (skin.vertices_in_ct[static_cast<std::size_t>(t[1])] - skin.vertices_in_ct[static_cast<std::size_t>(t[0])])
                .cross(skin.vertices_in_ct[static_cast<std::size_t>(t[2])] -
                       skin.vertices_in_ct[static_cast<std::size_t>(t[0])])
                .normalized();
        const double light = std::max(
            0.0, -normal.dot(view.forward) * 0.8 - 0.25 * normal.dot(view.down) + 0.15 * normal.dot(view.right));
        const double area = (p[1] - p[0]).x() * (p[2] - p[0]).y() - (p[1] - p[0]).y() * (p[2] - p[0]).x();
        if (std::abs(area) < 1e-9) continue;
        const auto low = [&](int a) { return std::min({p[0][a], p[1][a], p[2][a]}); };
        const auto high = [&](int a) { return std::max({p[0][a], p[1][a], p[2][a]}); };
        for (int y = std::max(0, static_cast<int>(std::ceil(low(1))));
             y <= std::min(kTile - 1, static_cast<int>(high(1))); ++y)
            for (int x = std::max(0, static_cast<int>(std::ceil(low(0))));
                 x <= std::min(kTile - 1, static_cast<int>(high(0))); ++x) {
                const double b = ((x - p[0].x()) * (p[2] - p[0]).y() - (y - p[0].y()) * (p[2] - p[0]).x()) / area;
                const double c = ((p[1] - p[0]).x() * (y - p[0].y()) - (p[1] - p[0]).y() * (x - p[0].x())) / area;
                if (b < -1e-9 || c < -1e-9 || b + c > 1 + 1e-9) continue;
                const double z = p[0].z() + b * (p[1] - p[0]).z() + c * (p[2] - p[0]).z();
                double& nearest = depth[static_cast<std::size_t>(y) * kTile + static_cast<std::size_t>(x)];
                if (z >= nearest) continue;
                nearest = z;
                sheet.pixels[sheet.index(x0 + x, y0 + y)] = shade(light, flag);
            }
    }
    for (const Vector3d& mark : marks) {
        const Vector3d at = mark - frame.middle;
        const int x = static_cast<int>(std::lround(kTile / 2.0 + at.dot(view.right) / frame.mm_per_pixel)),
                  y = static_cast<int>(std::lround(kTile / 2.0 + at.dot(view.down) / frame.mm_per_pixel));
        if (x < 1 || y < 1 || x + 1 >= kTile || y + 1 >= kTile) continue;
        if (at.dot(view.forward) >
            depth[static_cast<std::size_t>(y) * kTile + static_cast<std::size_t>(x)] + kNearMark_mm)
            continue;
        for (const auto& [dx, dy] : {std::pair(0, 0), std::pair(1, 0), std::pair(0, 1), std::pair(1, 1)})
            sheet.pixels[sheet.index(x0 + x + dx, y0 + y + dy)] = kMark;
    }
}

void draw_slice(RgbImage& sheet, int x0, int y0, const Volume& volume, const TriangleMesh& skin,
                const std::vector<Vector3d>& marks, const View& view, const Frame& frame, double black, double white) {
    const Eigen::Affine3d voxel_from_ct = volume.ct_from_voxel.inverse();
    for (int y = 0; y < kTile; ++y)
        for (int x = 0; x < kTile; ++x) {
            const Vector3d at =
                frame.middle + frame.mm_per_pixel * ((x - kTile / 2.0) * view.right + (y - kTile / 2.0) * view.down);
            const double value = value_at(volume, voxel_from_ct * at).value_or(NAN);
            const double grey =
                std::isfinite(value) ? 255 * std::sqrt(std::clamp((value - black) / (white - black), 0.0, 1.0)) : 30;
            const auto g = static_cast<std::uint8_t>(grey);
            sheet.pixels[sheet.index(x0 + x, y0 + y)] = {g, g, std::isfinite(value) ? g : std::uint8_t{60}};
        }
    for (const auto& t : skin.triangles) {  // where the triangle's edges cross the plane
        std::array<Vector3d, 3> p;
        for (std::size_t c = 0; c < 3; ++c) p[c] = skin.vertices_in_ct[static_cast<std::size_t>(t[c])] - frame.middle;
        std::vector<Vector3d> ends;
        for (std::size_t c = 0; c < 3; ++c) {
            const double a = p[c].dot(view.forward), b = p[(c + 1) % 3].dot(view.forward);
            if ((a < 0) != (b < 0)) ends.push_back(p[c] + a / (a - b) * (p[(c + 1) % 3] - p[c]));
        }
        if (ends.size() != 2) continue;
        const int steps = 1 + static_cast<int>((ends[1] - ends[0]).norm() / frame.mm_per_pixel);
        for (int s = 0; s <= steps; ++s) {
            const Vector3d e = ends[0] + s * (ends[1] - ends[0]) / steps;
            const int x = static_cast<int>(std::lround(kTile / 2.0 + e.dot(view.right) / frame.mm_per_pixel)),
                      y = static_cast<int>(std::lround(kTile / 2.0 + e.dot(view.down) / frame.mm_per_pixel));
            if (x >= 0 && y >= 0 && x < kTile && y < kTile) sheet.pixels[sheet.index(x0 + x, y0 + y)] = {255, 70, 60};
        }
    }
    for (const Vector3d& mark : marks) {
        const Vector3d at = mark - frame.middle;
        if (std::abs(at.dot(view.forward)) > 2) continue;
        const int x = static_cast<int>(std::lround(kTile / 2.0 + at.dot(view.right) / frame.mm_per_pixel)),
                  y = static_cast<int>(std::lround(kTile / 2.0 + at.dot(view.down) / frame.mm_per_pixel));
        if (x >= 0 && y >= 0 && x < kTile && y < kTile) sheet.pixels[sheet.index(x0 + x, y0 + y)] = kMark;
    }
}

std::pair<double, double> window_of(const Volume& volume) {
    std::vector<float> sample;
    for (std::size_t v = 0; v < volume.values.size(); v += 31)
        if (std::isfinite(volume.values[v])) sample.push_back(volume.values[v]);
    std::sort(sample.begin(), sample.end());
    if (sample.empty()) return {0, 1};
    if (volume.is_hu) return {-1024, 1000};
    const double low = static_cast<double>(sample[sample.size() / 500]),
                 high = static_cast<double>(sample[sample.size() * 199 / 200]);
    return {low, high > low ? high : low + 1};
}

}  // namespace

RgbImage head_sheet(const Volume& volume, const TriangleMesh& skin, const std::vector<Vector3d>& marks) {
    RgbImage sheet(5 * kTile, 2 * kTile, {12, 14, 18});
    if (skin.vertices_in_ct.empty()) return sheet;
    Vector3d low = skin.vertices_in_ct.front(), high = low;
    for (const auto& p : skin.vertices_in_ct) low = low.cwiseMin(p), high = high.cwiseMax(p);
    Frame frame{(low + high) / 2, (high - low).maxCoeff() / (kTile - 12)};
    const Vector3d left(1, 0, 0), back(0, 1, 0), up(0, 0, 1);
    const View views[] = {
        {left, -up, back}, {back, -up, -left}, {-back, -up, left}, {-left, -up, -back}, {left, back, -up}};
    for (int v = 0; v < 5; ++v) draw_view(sheet, v * kTile, 0, skin, marks, views[v], frame);
    const auto [black, white] = window_of(volume);
    const View sagittal{back, -up, left}, coronal{left, -up, back}, axial{left, back, up};
    const auto at = [&](const Vector3d& aside) { return Frame{frame.middle + aside, frame.mm_per_pixel}; };
    draw_slice(sheet, 0, kTile, volume, skin, marks, sagittal, at({0, 0, 0}), black, white);
    draw_slice(sheet, kTile, kTile, volume, skin, marks, sagittal, at({32, 0, 0}), black, white);
    draw_slice(sheet, 2 * kTile, kTile, volume, skin, marks, coronal, at({0, 0, 0}), black, white);
    draw_slice(sheet, 3 * kTile, kTile, volume, skin, marks, axial, at({0, 0, 0}), black, white);
    draw_slice(sheet, 4 * kTile, kTile, volume, skin, marks, axial, at({0, 0, high.z() - 70 - frame.middle.z()}), black,
               white);
    return sheet;
}

}  // namespace planlight::test
