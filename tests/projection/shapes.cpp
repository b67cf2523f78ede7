#include "tests/projection/shapes.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <string>

namespace planlight::test {
namespace {
using Eigen::Vector3d;
}

TriangleMesh ball_mesh(double radius_mm, int halvings) {
    TriangleMesh mesh;
    const double g = std::numbers::phi;
    for (const auto& v : {Vector3d(-1, g, 0), Vector3d(1, g, 0), Vector3d(-1, -g, 0), Vector3d(1, -g, 0),
                          Vector3d(0, -1, g), Vector3d(0, 1, g), Vector3d(0, -1, -g), Vector3d(0, 1, -g),
                          Vector3d(g, 0, -1), Vector3d(g, 0, 1), Vector3d(-g, 0, -1), Vector3d(-g, 0, 1)})
        mesh.vertices_in_ct.push_back(radius_mm * v.normalized());
    mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    for (int h = 0; h < halvings; ++h) {
        std::map<std::pair<int, int>, std::int32_t> middles;
        const auto middle = [&](std::int32_t a, std::int32_t b) {
            const auto [entry, fresh] =
                middles.emplace(std::minmax(a, b), static_cast<std::int32_t>(mesh.vertices_in_ct.size()));
            if (fresh) {
                const Vector3d m =
                    mesh.vertices_in_ct[static_cast<std::size_t>(a)] + mesh.vertices_in_ct[static_cast<std::size_t>(b)];
                mesh.vertices_in_ct.push_back(radius_mm * m.normalized());
            }
            return entry->second;
        };
        std::vector<std::array<std::int32_t, 3>> finer;
        for (const auto& t : mesh.triangles) {
            const auto ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
            finer.insert(finer.end(), {{t[0], ab, ca}, {t[1], bc, ab}, {t[2], ca, bc}, {ab, bc, ca}});
        }
        mesh.triangles = std::move(finer);
    }
    return mesh;
}

namespace {

/// A grid of nu x nv vertices, diagonals alternating; `closed_u` joins the last column to the first.
TriangleMesh grid(int nu, int nv, bool closed_u, const auto& vertex) {
    TriangleMesh mesh;
    for (int v = 0; v < nv; ++v)
        for (int u = 0; u < nu; ++u) mesh.vertices_in_ct.push_back(vertex(u, v));
    const auto at = [&](int u, int v) { return v * nu + u % nu; };
    for (int v = 0; v + 1 < nv; ++v)
        for (int u = 0; u < (closed_u ? nu : nu - 1); ++u) {
            const auto a = at(u, v), b = at(u + 1, v), c = at(u + 1, v + 1), d = at(u, v + 1);
            if ((u + v) % 2 == 0)
                mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
            else
                mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {b, c, d}});
        }
    return mesh;
}

}  // namespace

const SkinSurface& ball() {
    static const SkinSurface kBall(ball_mesh(kBallRadius_mm, 5));
    return kBall;
}

Vector3d on_ball(double longitude, double latitude) {
    return kBallRadius_mm * Vector3d(std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
                                     std::sin(latitude));
}

TriangleMesh tube_mesh(double radius_mm, double length_mm, double edge_mm) {
    const int around = static_cast<int>(std::ceil(2 * std::numbers::pi * radius_mm / edge_mm));
    const int along = static_cast<int>(std::ceil(length_mm / edge_mm)) + 1;
    return grid(around, along, true, [&](int u, int v) {
        const double angle = 2 * std::numbers::pi * u / around;
        return Vector3d(radius_mm * std::cos(angle), radius_mm * std::sin(angle),
                        length_mm * (static_cast<double>(v) / (along - 1) - 0.5));
    });
}

TriangleMesh sheet_mesh(double side_mm, double edge_mm) {
    const int n = static_cast<int>(std::ceil(side_mm / edge_mm)) + 1;
    return grid(n, n, false, [&](int u, int v) {
        const double wobble = u % 3 == 1 && v % 2 == 1 ? 0.3 * edge_mm : 0;
        return Vector3d(side_mm * (static_cast<double>(u) / (n - 1) - 0.5) + wobble,
                        side_mm * (static_cast<double>(v) / (n - 1) - 0.5), 0);
    });
}

TriangleMesh cut_ball_mesh(double radius_mm, double cut_z_mm, SkinFlag lid) {
    constexpr int kAround = 120, kRings = 50, kLidRings = 24;
    const double top = std::acos(cut_z_mm / radius_mm), rim_mm = radius_mm * std::sin(top);
    const auto ring_point = [](double r, double z, int i) {
        const double around = 2 * std::numbers::pi * i / kAround;
        return Vector3d(r * std::cos(around), r * std::sin(around), z);
    };
    // Rings from the south up to the rim, then inwards over the lid.
    TriangleMesh mesh = grid(kAround, kRings + kLidRings, true, [&](int u, int v) {
        if (v < kRings) {
            const double slope = std::numbers::pi - 0.02 - (std::numbers::pi - 0.02 - top) * v / (kRings - 1);
            return ring_point(radius_mm * std::sin(slope), radius_mm * std::cos(slope), u);
        }
        return ring_point(rim_mm * (kLidRings - (v - kRings) - 1 + 0.01) / kLidRings, cut_z_mm, u);
    });
    for (std::size_t i = 0; i < mesh.vertices_in_ct.size(); ++i)
        mesh.flags.push_back(i < static_cast<std::size_t>(kAround * kRings) ? kSkin : lid);
    return mesh;
}

TriangleMesh both(TriangleMesh a, const TriangleMesh& b, const Vector3d& shift_of_b_mm) {
    const auto first = static_cast<std::int32_t>(a.vertices_in_ct.size());
    for (const Vector3d& p : b.vertices_in_ct) a.vertices_in_ct.push_back(p + shift_of_b_mm);
    for (const auto& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    return a;
}

CameraModel projector_looking_at(const Vector3d& target_in_rig, const Vector3d& from_direction, double distance_mm,
                                 const Vector3d& up) {
    CameraModel p;
    p.width = 1920;
    p.height = 1080;
    p.focal_x = 2450;
    p.focal_y = 2440;
    p.centre_x = 973.4;
    p.centre_y = 610.2;
    p.k1 = -0.12;
    p.k2 = 0.09;
    p.p1 = 0.0015;
    p.p2 = -0.0011;
    const Vector3d forward = -from_direction.normalized(), right = forward.cross(up).normalized();
    Eigen::Matrix3d device_from_rig;
    device_from_rig << right.transpose(), forward.cross(right).transpose(), forward.transpose();
    p.device_from_rig.linear() = device_from_rig;
    p.device_from_rig.translation() = -device_from_rig * (target_in_rig - distance_mm * forward);
    return p;
}

double light_of_number(std::uint8_t number) {
    return std::pow(number / 255.0, 2.2);
}

void keep_picture(const RgbImage& picture, const char* name) {
    const char* folder = std::getenv("PLANLIGHT_PICTURES");
    if (folder == nullptr) return;
    cv::Mat bgr(picture.height, picture.width, CV_8UC3);
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const Rgb& c = picture.at(x, y);
            bgr.at<cv::Vec3b>(y, x) = {c[2], c[1], c[0]};
        }
    cv::imwrite(std::string(folder) + "/" + name, bgr);
}

}  // namespace planlight::test
