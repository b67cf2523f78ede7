#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tests/registration/scan/solid_optics.h"

namespace planlight::solid_room {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr int kBounces = 28;

double spots(const Vector3d& p) {
    return std::sin(1.9 * p.x() + 0.7 * p.y()) * std::sin(1.3 * p.y() - 0.9 * p.z()) +
           0.6 * std::sin(0.41 * p.x()) * std::sin(0.53 * p.y());
}

}  // namespace

Exposure::Exposure(const Room& room, const Device& camera, unsigned seed) : room_(room), camera_(camera), seed_(seed) {
    trace(room);
    if (room.material.bounced > 0) bounce(room);
}

void Exposure::trace(const Room& room) {
    const std::size_t count = static_cast<std::size_t>(camera_.width) * static_cast<std::size_t>(camera_.height);
    const Vector3d eye = eye_of(camera_), lamp = eye_of(room.projector);
    constexpr double kSub = 0.25;
    direct_.assign(4, std::vector<Path>(count, Path{0, 0, 0}));
    mirrored_.assign(count, Path{0, 0, 0});
    albedo_.assign(count, 0);
    code_.assign(count, {kNaN, kNaN});
    points_.assign(count, Vector3d::Constant(kNaN));
    tbb::parallel_for(0, camera_.height, [&](int y) {
        for (int x = 0; x < camera_.width; ++x) {
            const std::size_t i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width) + static_cast<std::size_t>(x);
            for (std::size_t sub = 0; sub < 5; ++sub) {  // four parts, and the middle for the truth
                const double dx = sub == 4 ? 0 : sub % 2 ? kSub : -kSub, dy = sub == 4 ? 0 : sub / 2 ? kSub : -kSub;
                const Vector3d way = way_of(camera_, x + dx, y + dy);
                const auto t = march(room.solid, eye, way, 100, kFar_mm);
                if (!t) continue;
                const Vector3d p = eye + *t * way, n = normal_at(room.solid, p);
                const double albedo = room.material.albedo * (1 + room.material.texture * spots(p) / 2);
                const auto lit = lit_at(room, p, n);
                if (sub == 4) {
                    points_[i] = p;
                    albedo_[i] = static_cast<float>(albedo);
                    if (lit) code_[i] = lit->pixel;
                    if (room.material.gloss > 0) {
                        const Vector3d mirrored = (way - 2 * way.dot(n) * n).normalized();
                        const auto other = march(room.solid, p + 0.5 * n, mirrored, 0.3, 200);
                        if (!other) continue;
                        const Vector3d q = p + 0.5 * n + *other * mirrored;
                        if (const auto there = lit_at(room, q, normal_at(room.solid, q)))
                            mirrored_[i] = {
                                static_cast<float>(there->pixel.x()), static_cast<float>(there->pixel.y()),
                                static_cast<float>(room.material.gloss * room.material.albedo * there->brightness)};
                    }
                    continue;
                }
                if (!lit) continue;
                const double halfway = std::max(0.0, n.dot(((lamp - p).normalized() - way).normalized()));
                const double share =
                    albedo * lit->brightness + room.material.gloss * std::pow(halfway, room.material.gloss_power);
                direct_[sub][i] = {static_cast<float>(lit->pixel.x()), static_cast<float>(lit->pixel.y()),
                                   static_cast<float>(share)};
            }
        }
    });
}

void Exposure::bounce(const Room& room) {
    const int columns = camera_.width / kLattice_px + 1, rows = camera_.height / kLattice_px + 1;
    const Vector3d eye = eye_of(camera_);
    bounced_.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), {});
    tbb::parallel_for(0, rows, [&](int r) {
        std::mt19937 random(seed_ + 7919u * static_cast<unsigned>(r));
        std::uniform_real_distribution<double> even(0, 1);
        for (int c = 0; c < columns; ++c) {
            const Vector3d way = way_of(camera_, c * kLattice_px, r * kLattice_px);
            const auto t = march(room.solid, eye, way, 100, kFar_mm);
            if (!t) continue;
            const Vector3d p = eye + *t * way, n = normal_at(room.solid, p), side = n.unitOrthogonal(),
                           other = n.cross(side);
            auto& paths =
                bounced_[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(c)];
            for (int k = 0; k < kBounces; ++k) {
                const double radius = std::sqrt(even(random)), turn = 2 * std::numbers::pi * even(random);
                const Vector3d out = radius * std::cos(turn) * side + radius * std::sin(turn) * other +
                                     std::sqrt(1 - radius * radius) * n;
                const auto met = march(room.solid, p + 0.5 * n, out, 0.3, 250);
                if (!met) continue;
                const Vector3d q = p + 0.5 * n + *met * out;
                const auto lit = lit_at(room, q, normal_at(room.solid, q));
                if (!lit) continue;
                // A further bounce or two, taken as 1.4 times the first.
                const double share = 1.4 * room.material.bounced * room.material.albedo * room.material.albedo *
                                     lit->brightness / kBounces;
                paths.push_back({static_cast<float>(lit->pixel.x()), static_cast<float>(lit->pixel.y()),
                                 static_cast<float>(share)});
            }
        }
    });
}

}  // namespace planlight::solid_room
