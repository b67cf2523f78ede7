#include "tests/registration/scan/stripe_room.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace planlight::stripe_room {
namespace {

const double kNaN = std::numeric_limits<double>::quiet_NaN();

cv::Matx33d matrix_of(const Optics& o) {
    return {o.fx, 0, o.cx, 0, o.fy, o.cy, 0, 0, 1};
}
cv::Mat distortion_of(const Optics& o) {
    return cv::Mat(1, 5, CV_64F, const_cast<double*>(o.distortion.data())).clone();
}

Optics looking_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Eigen::Vector3d& down) {
    Optics o;
    const Eigen::Vector3d z = (target - eye).normalized(), x = down.cross(z).normalized(), y = z.cross(x);
    o.R << x.transpose(), y.transpose(), z.transpose();
    o.t = -o.R * eye;
    return o;
}

void set_lens(Optics& o, int width, int height, double focal, double cx, double cy, std::array<double, 5> distortion) {
    o.width = width;
    o.height = height;
    o.fx = focal;
    o.fy = focal * 1.003;
    o.cx = cx;
    o.cy = cy;
    o.distortion = distortion;
}

/// Two cameras beside a projector, all looking at a place 900 mm away; the room's axes are those of no device.
Room room_of(Surface surface) {
    const Eigen::Vector3d target(120, -40, 300), back = Eigen::Vector3d(0.1, 0.35, -1).normalized();
    const Eigen::Vector3d side = Eigen::Vector3d(1, 0.05, 0).cross(back).cross(back).normalized() * -1,
                          down = back.cross(side).normalized() * -1;
    Room room;
    room.projector = looking_at(target + 900 * back, target, down);
    room.left = looking_at(target + 880 * back - 210 * side + 15 * down, target, down);
    room.right = looking_at(target + 910 * back + 200 * side - 10 * down, target, down);
    room.surface = std::move(surface);
    return room;
}

/// Light along one direction of a picture: pixels are squares of even light, then the lens blurs. Samples of 1/16
/// pixel.
class Profile {
public:
    Profile(const std::vector<double>& values, double blur_px) : size_(static_cast<int>(values.size())) {
        const int fine = size_ * kFine + 2 * kMargin;
        std::vector<double> sharp(static_cast<std::size_t>(fine), 0.0);
        for (int i = 0; i < size_ * kFine; ++i)
            sharp[static_cast<std::size_t>(i + kMargin)] = values[static_cast<std::size_t>(i / kFine)];
        cv::Mat(1, fine, CV_64F, sharp.data()).copyTo(fine_);
        if (blur_px > 0) cv::GaussianBlur(fine_, fine_, cv::Size(0, 0), blur_px * kFine, 1e-6, cv::BORDER_CONSTANT);
    }
    /// At a pixel coordinate (0: the centre of the first pixel).
    double at(double pixel) const {
        const double s = (pixel + 0.5) * kFine - 0.5 + kMargin;
        if (!(s >= 0 && s < fine_.cols - 1)) return 0;
        const int i = static_cast<int>(s);
        const double* const here = fine_.ptr<double>(0) + i;
        return here[0] + (s - i) * (here[1] - here[0]);
    }

private:
    static constexpr int kFine = 16, kMargin = 8 * kFine;
    int size_;
    cv::Mat fine_;
};

/// What reaches each sub-sample of a camera: its place in the projector's picture and its shade (0: no projector
/// light).
struct Sample {
    float u, v, shade, albedo;
};

std::vector<Sample> samples_of(const Room& room, const Optics& camera, double dx, double dy) {
    std::vector<Eigen::Vector2d> pixels;
    for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x) pixels.emplace_back(x + dx, y + dy);
    const auto directions = camera.directions_of(pixels);
    const Eigen::Vector3d eye = camera.eye(), lamp = room.projector.eye();
    std::vector<Sample> samples(pixels.size(), Sample{0, 0, 0, 0});
    std::vector<Eigen::Vector3d> lit_points;
    std::vector<std::size_t> lit;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const auto hit = room.surface(eye, directions[i]);
        if (!hit) continue;
        samples[i].albedo = 1;
        const Eigen::Vector3d p = eye + hit->distance * directions[i], to_p = p - lamp;
        const double away = to_p.norm(), cosine = -hit->normal.dot(to_p) / away, seen = -hit->normal.dot(directions[i]);
        if (cosine * seen <= 0) continue;  // the camera and the lamp are on different sides
        const auto first = room.surface(lamp, to_p / away);
        if (!first || first->distance < away - 0.01) continue;  // in shadow
        const double halfway = std::abs(hit->normal.dot((directions[i] + to_p / away).normalized()));
        const double glint = room.light.glint_grey / room.light.white_grey * std::pow(halfway, room.light.glint_power);
        samples[i].shade = static_cast<float>((std::abs(cosine) + glint) * 810000 / (away * away));
        lit_points.push_back(p);
        lit.push_back(i);
    }
    const auto codes = room.projector.pixels_of(lit_points);
    for (std::size_t k = 0; k < lit.size(); ++k) {
        samples[lit[k]].u = static_cast<float>(codes[k].x());
        samples[lit[k]].v = static_cast<float>(codes[k].y());
    }
    return samples;
}

}  // namespace

std::vector<Eigen::Vector2d> Optics::pixels_of(const std::vector<Eigen::Vector3d>& points) const {
    if (points.empty()) return {};
    std::vector<cv::Point3d> in;
    for (const auto& p : points) in.emplace_back(p.x(), p.y(), p.z());
    const cv::Matx33d rotation(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2));
    cv::Mat twist;
    cv::Rodrigues(rotation, twist);
    std::vector<cv::Point2d> out;
    cv::projectPoints(in, twist, cv::Vec3d(t.x(), t.y(), t.z()), matrix_of(*this), distortion_of(*this), out);
    std::vector<Eigen::Vector2d> pixels;
    for (const auto& p : out) pixels.emplace_back(p.x, p.y);
    return pixels;
}

std::vector<Eigen::Vector3d> Optics::directions_of(const std::vector<Eigen::Vector2d>& pixels) const {
    std::vector<cv::Point2d> in, out;
    for (const auto& p : pixels) in.emplace_back(p.x(), p.y());
    cv::undistortPoints(in, out, matrix_of(*this), distortion_of(*this), cv::noArray(), cv::noArray(),
                        cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 40, 1e-10));
    std::vector<Eigen::Vector3d> directions;
    for (const auto& p : out) directions.push_back((R.transpose() * Eigen::Vector3d(p.x, p.y, 1)).normalized());
    return directions;
}

Surface plane(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double radius_mm) {
    return [=](const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) -> std::optional<Hit> {
        const double distance = normal.dot(point - origin) / normal.dot(direction);
        if (!(distance > 1e-6) || (origin + distance * direction - point).norm() > radius_mm) return std::nullopt;
        return Hit{distance, normal};
    };
}

Surface sphere(const Eigen::Vector3d& centre, double radius_mm) {
    return [=](const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) -> std::optional<Hit> {
        const Eigen::Vector3d to = centre - origin;
        const double along = to.dot(direction), inside = radius_mm * radius_mm - (to.squaredNorm() - along * along);
        if (inside <= 0) return std::nullopt;
        const double distance = along - std::sqrt(inside);
        if (distance <= 1e-6) return std::nullopt;
        return Hit{distance, (origin + distance * direction - centre) / radius_mm};
    };
}

Surface nearest_of(std::vector<Surface> surfaces) {
    return [surfaces = std::move(surfaces)](const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
        std::optional<Hit> best;
        for (const Surface& s : surfaces)
            if (const auto hit = s(origin, direction); hit && (!best || hit->distance < best->distance)) best = hit;
        return best;
    };
}

Room paper_room(Surface surface) {
    Room room = room_of(std::move(surface));
    set_lens(room.left, 744, 576, 2050, 380, 280, {-0.11, 0.05, 0.0006, -0.0004, 0});
    set_lens(room.right, 744, 576, 2075, 366, 295, {-0.09, 0.03, -0.0005, 0.0007, 0});
    set_lens(room.projector, 800, 600, 2250, 402, 420, {0.04, -0.03, 0.0004, 0.0003, 0});
    return room;
}

Room modern_room(Surface surface) {
    Room room = room_of(std::move(surface));
    set_lens(room.left, 1920, 1200, 5000, 970, 590, {-0.11, 0.05, 0.0006, -0.0004, 0});
    set_lens(room.right, 1920, 1200, 5050, 948, 610, {-0.09, 0.03, -0.0005, 0.0007, 0});
    set_lens(room.projector, 1920, 1080, 5400, 965, 760, {0.04, -0.03, 0.0004, 0.0003, 0});
    return room;
}

Truth truth_of(const Room& room, const Optics& camera) {
    Truth truth;
    std::vector<Eigen::Vector2d> pixels;
    for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x) pixels.emplace_back(x, y);
    const auto directions = camera.directions_of(pixels);
    const auto samples = samples_of(room, camera, 0, 0);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const bool lit = samples[i].shade > 0 && samples[i].u > -0.5f && samples[i].v > -0.5f &&
                         samples[i].u < static_cast<float>(room.projector.width) - 0.5f &&
                         samples[i].v < static_cast<float>(room.projector.height) - 0.5f;
        const auto hit = room.surface(camera.eye(), directions[i]);
        truth.code.push_back(lit ? Eigen::Vector2d(samples[i].u, samples[i].v) : Eigen::Vector2d(kNaN, kNaN));
        truth.point.push_back(hit ? Eigen::Vector3d(camera.eye() + hit->distance * directions[i])
                                  : Eigen::Vector3d(kNaN, kNaN, kNaN));
    }
    return truth;
}

namespace {

/// A place that the projector's light reaches: the camera's pixel that sees it, where it lies along the picture, and
/// how bright white is there (darker at the picture's rim).
struct LitPlace {
    std::size_t pixel;
    float at;
    double white_grey;
};

/// `across`: how many projector pixels the picture has the other way.
std::vector<LitPlace> lit_places(const std::vector<std::vector<Sample>>& samples, const Light& light, bool along_rows,
                                 int across) {
    const Profile edge(std::vector<double>(static_cast<std::size_t>(across), 1.0), light.projector_blur_px);
    std::vector<LitPlace> places;
    for (const auto& sub : samples)
        for (std::size_t i = 0; i < sub.size(); ++i)
            if (const Sample& s = sub[i]; s.shade > 0)
                places.push_back(
                    {i, along_rows ? s.v : s.u, s.shade * light.white_grey * edge.at(along_rows ? s.u : s.v)});
    return places;
}

}  // namespace

std::vector<GrayImage> photograph(const Room& room, const Optics& camera, const StripeSettings& stripes,
                                  unsigned seed) {
    std::vector<Shown> pictures;
    for (const StripePattern& pattern : stripe_sequence(stripes))
        pictures.push_back({draw_stripes(stripes, pattern), pattern.along_rows});
    return photograph(room, camera, pictures, seed);
}

std::vector<GrayImage> photograph(const Room& room, const Optics& camera, const std::vector<Shown>& pictures,
                                  unsigned seed) {
    std::vector<std::vector<Sample>> samples;
    for (const double dy : {-0.25, 0.25})
        for (const double dx : {-0.25, 0.25}) samples.push_back(samples_of(room, camera, dx, dy));
    std::mt19937 random(seed);
    std::normal_distribution<float> normal;
    constexpr std::size_t kNoises = 1 << 18;
    std::vector<float> noise(kNoises);
    for (float& n : noise) n = normal(random);
    const Light& light = room.light;
    std::vector<double> ambient(samples[0].size());  // of a pixel, of all its places
    for (const auto& sub : samples)
        for (std::size_t i = 0; i < sub.size(); ++i) ambient[i] += sub[i].albedo * light.ambient_grey;
    std::array<std::vector<LitPlace>, 2> lit;  // for pictures that change along x, and along y
    std::vector<GrayImage> frames;
    for (const auto& [picture, along_rows] : pictures) {
        const int length = along_rows ? picture.height : picture.width;
        std::vector<double> values;
        for (int i = 0; i < length; ++i)
            values.push_back(std::pow((along_rows ? picture.at(0, i) : picture.at(i, 0))[1] / 255.0, light.gamma));
        const Profile profile(values, light.projector_blur_px);
        std::vector<LitPlace>& places = lit[along_rows ? 1 : 0];
        if (places.empty())
            places = lit_places(samples, light, along_rows, along_rows ? picture.width : picture.height);
        std::vector<double> sum = ambient;
        for (const LitPlace& place : places) sum[place.pixel] += place.white_grey * profile.at(place.at);
        cv::Mat seen(camera.height, camera.width, CV_32F);
        auto* pixel = seen.ptr<float>();
        for (std::size_t i = 0; i < sum.size(); ++i)
            pixel[i] = static_cast<float>(sum[i] / static_cast<double>(samples.size()));
        if (light.camera_blur_px > 0) cv::GaussianBlur(seen, seen, cv::Size(0, 0), light.camera_blur_px);
        GrayImage frame(camera.width, camera.height);
        std::size_t at = random() % kNoises;
        for (std::size_t i = 0; i < frame.pixels.size(); ++i) {
            at = (at + 1) % kNoises;
            if (i % 977 == 0) at = random() % kNoises;
            const float value = pixel[i] + static_cast<float>(light.noise_grey) * noise[at];
            frame.pixels[i] = static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
        }
        frames.push_back(std::move(frame));
    }
    return frames;
}

ScanCapture capture(const Room& room, const StripeSettings& stripes) {
    ScanCapture capture;
    capture.stripes = stripes;
    capture.left = photograph(room, room.left, stripes, room.light.seed);
    capture.right = photograph(room, room.right, stripes, room.light.seed + 1000);
    return capture;
}

StripeSettings stripes_of(const Room& room) {
    StripeSettings stripes;
    stripes.width = room.projector.width;
    stripes.height = room.projector.height;
    return stripes;
}

CameraModel model_of(const Optics& o) {
    CameraModel model;
    model.width = o.width;
    model.height = o.height;
    model.focal_x = o.fx;
    model.focal_y = o.fy;
    model.centre_x = o.cx;
    model.centre_y = o.cy;
    model.k1 = o.distortion[0];
    model.k2 = o.distortion[1];
    model.p1 = o.distortion[2];
    model.p2 = o.distortion[3];
    model.k3 = o.distortion[4];
    model.device_from_rig.linear() = o.R;
    model.device_from_rig.translation() = o.t;
    return model;
}

RigCalibration rig_of(const Room& room) {
    RigCalibration rig;
    rig.left_camera = model_of(room.left);
    rig.right_camera = model_of(room.right);
    rig.projector = model_of(room.projector);
    return rig;
}

}  // namespace planlight::stripe_room
