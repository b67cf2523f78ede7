#include "tests/registration/scan/solid_room.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <random>

namespace planlight::solid_room {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr int kLattice_px = 6, kBounces = 28;
constexpr double kFar_mm = 1500;

double smooth_min(double a, double b, double k) {
    const double h = std::max(k - std::abs(a - b), 0.0) / k;
    return std::min(a, b) - h * h * k / 4;
}

/// A lower bound of the distance to an ellipsoid.
double ellipsoid(const Vector3d& p, const Vector3d& half) {
    const double k0 = p.cwiseQuotient(half).norm(), k1 = p.cwiseQuotient(half.cwiseProduct(half)).norm();
    return k0 < 1 ? (k0 - 1) * half.minCoeff() : k0 * (k0 - 1) / k1;
}

/// A ring of radius R and thickness r about z, in a plane.
double ring(const Vector3d& p, double R, double r) {
    return std::hypot(std::hypot(p.x(), p.y()) - R, p.z()) - r;
}

Vector3d normal_at(const Solid& solid, const Vector3d& p) {
    constexpr double e = 0.02;
    Vector3d n;
    for (int k = 0; k < 3; ++k) n[k] = solid(p + e * Vector3d::Unit(k)) - solid(p - e * Vector3d::Unit(k));
    return n.normalized();
}

/// Sphere marching; empty where nothing is met.
std::optional<double> march(const Solid& solid, const Vector3d& from, const Vector3d& way, double begin, double end) {
    double t = begin;
    for (int step = 0; step < 200 && t < end; ++step) {
        const double d = solid(from + t * way);
        if (d < 0.01) return t;
        t += std::max(d, 0.02);
    }
    return std::nullopt;
}

Vector3d eye_of(const Device& d) {
    return d.device_from_room.inverse().translation();
}

std::optional<Eigen::Vector2d> pixel_of(const Device& d, const Vector3d& p) {
    const Vector3d q = d.device_from_room * p;
    if (q.z() <= 1) return std::nullopt;
    const double x = q.x() / q.z(), y = q.y() / q.z(), bent = 1 + d.k1 * (x * x + y * y);
    return Eigen::Vector2d(d.focal * x * bent + d.centre_x, d.focal * y * bent + d.centre_y);
}

Vector3d way_of(const Device& d, double px, double py) {
    const double X = (px - d.centre_x) / d.focal, Y = (py - d.centre_y) / d.focal;
    double x = X, y = Y;
    for (int k = 0; k < 20; ++k) {
        const double bent = 1 + d.k1 * (x * x + y * y);
        x = X / bent, y = Y / bent;
    }
    return (d.device_from_room.linear().transpose() * Vector3d(x, y, 1)).normalized();
}

double spots(const Vector3d& p) {
    return std::sin(1.9 * p.x() + 0.7 * p.y()) * std::sin(1.3 * p.y() - 0.9 * p.z()) +
           0.6 * std::sin(0.41 * p.x()) * std::sin(0.53 * p.y());
}

/// What the projector sends to a place directly: its pixel and how brightly; empty in its shadow.
struct Lit {
    Eigen::Vector2d pixel;
    double brightness;
};
std::optional<Lit> lit_at(const Room& room, const Vector3d& p, const Vector3d& normal) {
    const Vector3d lamp = eye_of(room.projector), to = p - lamp;
    const double away = to.norm(), facing = -normal.dot(to) / away;
    if (facing <= 0) return std::nullopt;
    const auto pixel = pixel_of(room.projector, p);
    if (!pixel || pixel->x() < -2 || pixel->y() < -2 || pixel->x() > room.projector.width + 1 ||
        pixel->y() > room.projector.height + 1)
        return std::nullopt;
    const auto first = march(room.solid, lamp, to / away, 50, away);
    if (first && *first < away - 0.3) return std::nullopt;
    return Lit{*pixel, facing * 360000 / (away * away)};
}

Device device(int width, int height, double focal, double k1, const Vector3d& eye, const Vector3d& target) {
    Device d{width, height, focal, width * 0.51, height * 0.48, k1, Eigen::Isometry3d::Identity()};
    const Vector3d z = (target - eye).normalized(), x = Vector3d(0.02, 1, 0).cross(z).normalized(), y = z.cross(x);
    d.device_from_room.linear() << x.transpose(), y.transpose(), z.transpose();
    d.device_from_room.translation() = -d.device_from_room.linear() * eye;
    return d;
}

/// The light along a direction of a picture, blurred; at any place.
class Profile {
public:
    Profile(const std::vector<double>& values, double blur_px, double leak) {
        constexpr int kFine = 8;
        cv::Mat fine(1, static_cast<int>(values.size()) * kFine, CV_64F);
        for (int i = 0; i < fine.cols; ++i)
            fine.at<double>(0, i) = leak + (1 - leak) * values[static_cast<std::size_t>(i / kFine)];
        cv::GaussianBlur(fine, fine, cv::Size(0, 0), std::max(0.05, blur_px) * kFine, 1e-6, cv::BORDER_CONSTANT);
        values_.assign(fine.begin<double>(), fine.end<double>());
    }
    float at(float pixel) const {
        const float s = (pixel + 0.5F) * 8 - 0.5F;
        const int i = static_cast<int>(std::floor(s));
        if (i < 0 || i + 1 >= static_cast<int>(values_.size())) return 0;
        const auto k = static_cast<std::size_t>(i);
        return static_cast<float>(values_[k]) +
               (s - static_cast<float>(i)) * static_cast<float>(values_[k + 1] - values_[k]);
    }

private:
    std::vector<double> values_;
};

}  // namespace

Solid ball(const Vector3d& centre, double radius_mm) {
    return [=](const Vector3d& p) { return (p - centre).norm() - radius_mm; };
}

Solid wall(const Vector3d& point, const Vector3d& normal) {
    return [=, n = Vector3d(normal.normalized())](const Vector3d& p) { return n.dot(p - point); };
}

Solid head(const Vector3d& centre) {
    return [=](const Vector3d& at) {
        const Vector3d p = at - centre;
        double d = ellipsoid(p, {72, 95, 85});
        d = smooth_min(d, ellipsoid(p - Vector3d(0, 10, -85), {11, 26, 20}), 12);  // nose
        d = smooth_min(d, ellipsoid(p - Vector3d(0, -22, -76), {45, 9, 9}), 16);   // brow
        for (const double side : {-1.0, 1.0}) {
            const Vector3d q = Eigen::AngleAxisd(side * 0.9, Vector3d::UnitY()) * (p - Vector3d(side * 76, 5, -22));
            d = smooth_min(d, ring(Vector3d(q.x(), q.y() * 0.65, q.z()), 17, 2.2) * 0.65, 3);  // rim of the ear
            d = smooth_min(d, ring(Vector3d(q.x() + 2, q.y() * 0.7, q.z()), 9, 2) * 0.7, 3);
        }
        return 0.8 * d;
    };
}

Solid shell(const Vector3d& centre) {
    std::vector<std::pair<Vector3d, double>> whorls;
    for (int k = 0; k < 70; ++k) {
        const double turn = 0.31 * k, size = std::exp(-0.034 * k);
        whorls.push_back(
            {centre + Vector3d(-48 + 105 * (1 - size), 21 * size * std::cos(turn), 21 * size * std::sin(turn)),
             23 * size});
    }
    return [=](const Vector3d& p) {
        double d = 1e9;
        for (const auto& [c, r] : whorls) d = std::min(d, (p - c).norm() - r);
        const Vector3d q = p - centre;
        const double ribs = 1.0 * std::pow(std::abs(std::sin(0.22 * (q.x() + 0.7 * q.y()))), 6.0);  // thin, 14 mm apart
        const double body = (d - ribs) * 0.7;
        const double mouth =
            ellipsoid(Vector3d(Eigen::AngleAxisd(0.5, Vector3d::UnitZ()) * (q - Vector3d(-40, 4, -34))), {22, 10, 26});
        return std::max(body, -mouth);
    };
}

Solid folds(const Vector3d& centre, double depth_mm) {
    constexpr double kApart = 14, kThick = 1.5;
    return [=](const Vector3d& at) {
        const Vector3d p = at - centre;
        const auto box = [](const Vector3d& q, const Vector3d& half) {
            const Vector3d o = q.cwiseAbs() - half;
            return o.cwiseMax(0.0).norm() + std::min(o.maxCoeff(), 0.0);
        };
        double d = box(p - Vector3d(0, 0, 10), {60, 45, 10});
        const double nearest = std::clamp(std::round(p.x() / kApart), -4.0, 4.0) * kApart;
        for (const double x : {nearest - kApart, nearest, nearest + kApart})
            d = smooth_min(d, box(p - Vector3d(x, 0, -depth_mm / 2), {kThick / 2, 40, depth_mm / 2}) - 0.3, 2);
        return d;
    };
}

Room desk_room(Solid solid, double pixels) {
    const Vector3d target(15, -10, 600);
    const auto size = [&](int n) { return static_cast<int>(std::lround(n * pixels)); };
    Room room;
    room.projector = device(912, 684, 1850, -0.05, Vector3d(0, 0, 0), target);
    room.projector.centre_y = 560;
    room.left = device(size(640), size(480), 1900 * pixels, 0.12, Vector3d(-160, 20, 15), target);
    room.right = device(size(640), size(480), 1930 * pixels, 0.09, Vector3d(150, -35, -10), target);
    room.solid = std::move(solid);
    return room;
}

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

GrayImage Exposure::picture(const std::vector<double>& values, bool along_rows) {
    const Photography& how = room_.photography;
    const Profile profile(values, how.projector_blur_px, 1 / how.contrast);
    const int across = along_rows ? room_.projector.width : room_.projector.height;
    const Profile rim(std::vector<double>(static_cast<std::size_t>(across), 1.0), how.projector_blur_px, 0);
    const auto light_of = [&](const Path& path) {
        return path.share <= 0
                   ? 0.0F
                   : path.share * profile.at(along_rows ? path.v : path.u) * rim.at(along_rows ? path.u : path.v);
    };
    const int columns = camera_.width / kLattice_px + 1, rows = camera_.height / kLattice_px + 1;
    cv::Mat coarse = cv::Mat::zeros(rows, columns, CV_32F), seen(camera_.height, camera_.width, CV_32F),
            mirrored = seen.clone();
    for (std::size_t k = 0; k < bounced_.size(); ++k)
        for (const Path& path : bounced_[k]) coarse.ptr<float>()[k] += light_of(path);
    for (int y = 0; y < camera_.height; ++y)
        for (int x = 0; x < camera_.width; ++x) {
            const std::size_t i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width) + static_cast<std::size_t>(x);
            float sum = 0;
            for (const auto& sub : direct_) sum += 0.25F * light_of(sub[i]);
            seen.at<float>(y, x) = sum;
            mirrored.at<float>(y, x) = light_of(mirrored_[i]);
        }
    if (room_.material.into_skin_px > 0) {
        cv::Mat spread;
        cv::GaussianBlur(seen, spread, cv::Size(0, 0), room_.material.into_skin_px);
        for (int y = 0; y < camera_.height; ++y)
            for (int x = 0; x < camera_.width; ++x) {
                const bool skin = albedo_[static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width) +
                                          static_cast<std::size_t>(x)] > 0;
                seen.at<float>(y, x) = 0.67F * seen.at<float>(y, x) + (skin ? 0.33F * spread.at<float>(y, x) : 0.0F);
            }
    }
    const auto between = [&](int x,
                             int y) {  // of the four lattice places round a pixel, those that have light paths at all
        float sum = 0, weights = 0;
        const float fx = static_cast<float>(x) / kLattice_px, fy = static_cast<float>(y) / kLattice_px;
        for (int j = 0; j < 2; ++j)
            for (int i = 0; i < 2; ++i) {
                const int c = static_cast<int>(fx) + i, r = static_cast<int>(fy) + j;
                if (c >= columns || r >= rows) continue;
                const float w = (1 - std::abs(fx - static_cast<float>(c))) * (1 - std::abs(fy - static_cast<float>(r)));
                sum += w * coarse.at<float>(r, c);
                weights += w;
            }
        return weights > 0 ? sum / weights : 0.0F;
    };
    for (int y = 0; y < camera_.height; ++y)
        for (int x = 0; x < camera_.width; ++x) {
            const std::size_t i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width) + static_cast<std::size_t>(x);
            if (albedo_[i] > 0 && !bounced_.empty()) seen.at<float>(y, x) += between(x, y);
            seen.at<float>(y, x) += mirrored.at<float>(y, x);
        }
    if (how.camera_blur_px > 0) cv::GaussianBlur(seen, seen, cv::Size(0, 0), how.camera_blur_px);
    std::mt19937 random(seed_++);
    std::normal_distribution<float> normal;
    GrayImage grey(camera_.width, camera_.height);
    const float* value = seen.ptr<float>();
    for (std::size_t i = 0; i < grey.pixels.size(); ++i) {
        double light = how.white_grey / 0.8 * static_cast<double>(value[i]) +
                       how.dark_grey * (0.4 + static_cast<double>(albedo_[i]));
        light += normal(random) * std::hypot(how.read_noise_grey, how.shot_noise * std::sqrt(std::max(0.0, light)) * 4);
        if (how.camera_gamma != 1) light = 255 * std::pow(std::clamp(light / 255, 0.0, 1.0), 1 / how.camera_gamma);
        grey.pixels[i] = static_cast<std::uint8_t>(std::clamp(std::lround(light), 0L, 255L));
    }
    return grey;
}

std::vector<double> shown(const StripeSettings& s, const StripePattern& pattern) {
    constexpr double kGamma = 1.8;  // of the projector
    using Kind = StripePattern::Kind;
    const int size = pattern.along_rows ? s.height : s.width,
              begins = pattern.along_rows ? s.begins_at_row : s.begins_at_column;
    const double cell_px = s.phase_period_px / 2;
    int bits = 1;
    while (std::pow(2.0, bits) < begins + size / cell_px) ++bits;
    std::vector<double> values(static_cast<std::size_t>(size), pattern.kind == Kind::white ? 1.0 : 0.0);
    for (int i = 0; i < size; ++i) {
        double& value = values[static_cast<std::size_t>(i)];
        const int number = begins + static_cast<int>(i / cell_px), gray = number ^ (number / 2);
        const bool set = gray / (1 << (bits - 1 - pattern.index)) % 2 == 1;
        if (pattern.kind == Kind::gray_bit) value = set ? 1 : 0;
        if (pattern.kind == Kind::gray_bit_inverse) value = set ? 0 : 1;
        if (pattern.kind != Kind::phase) continue;
        const double period = pattern.frequency == 0
                                  ? s.phase_period_px
                                  : s.order_periods_px.at(static_cast<std::size_t>(pattern.frequency - 1));
        const double steps = pattern.frequency == 0 ? s.phase_steps : s.order_steps;
        value = std::pow(
            std::round(127.5 + 127.5 * std::cos(2 * std::numbers::pi * (i / period - pattern.index / steps))) / 255,
            kGamma);
    }
    return values;
}

Cameras::Cameras(const Room& room)
    : left_(room, room.left, room.photography.seed), right_(room, room.right, room.photography.seed + 5000) {}

ScanCapture Cameras::capture(const StripeSettings& stripes, const std::vector<StripePattern>& partial) {
    ScanCapture capture;
    capture.stripes = stripes;
    capture.partial = partial;
    for (const StripePattern& pattern : partial.empty() ? stripe_sequence(stripes) : partial) {
        const std::vector<double> values = shown(stripes, pattern);
        capture.left.push_back(left_.picture(values, pattern.along_rows));
        capture.right.push_back(right_.picture(values, pattern.along_rows));
    }
    return capture;
}

RigCalibration rig_of(const Room& room) {
    const auto model = [](const Device& d) {
        CameraModel m;
        m.width = d.width, m.height = d.height;
        m.focal_x = m.focal_y = d.focal;
        m.centre_x = d.centre_x, m.centre_y = d.centre_y;
        m.k1 = d.k1;
        m.device_from_rig.linear() = d.device_from_room.linear();
        m.device_from_rig.translation() = d.device_from_room.translation();
        return m;
    };
    RigCalibration rig;
    rig.left_camera = model(room.left);
    rig.right_camera = model(room.right);
    rig.projector = model(room.projector);
    return rig;
}

std::vector<double> off_the_solid(const PointCloud& cloud, const Solid& solid) {
    std::vector<double> off;
    for (const Vector3d& p : cloud.points_in_rig) {  // down the slope of the distance: a bound of it is enough
        Vector3d q = p;
        for (int k = 0; k < 30 && std::abs(solid(q)) > 1e-3; ++k) q -= solid(q) * normal_at(solid, q);
        off.push_back((q - p).norm());
    }
    std::sort(off.begin(), off.end());
    return off;
}

}  // namespace planlight::solid_room
