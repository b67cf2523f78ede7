#include "tests/app/faulty_room.h"

#include <cmath>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "planning_io/plan/plan_file.h"

namespace planlight::test {

using namespace std::chrono_literals;
using Eigen::Vector2d;
using Eigen::Vector3d;
using simulation::SimulatedRig;

namespace {

Rgb between_pixels(const RgbImage& picture, const Vector2d& p) {
    const int x = static_cast<int>(std::floor(p.x())), y = static_cast<int>(std::floor(p.y()));
    if (x < 0 || y < 0 || x + 1 >= picture.width || y + 1 >= picture.height) return {0, 0, 0};
    const double u = p.x() - x, v = p.y() - y;
    Rgb mixed{};
    for (std::size_t c = 0; c < 3; ++c)
        mixed[c] =
            static_cast<std::uint8_t>((1 - v) * ((1 - u) * picture.at(x, y)[c] + u * picture.at(x + 1, y)[c]) +
                                      v * ((1 - u) * picture.at(x, y + 1)[c] + u * picture.at(x + 1, y + 1)[c]) + 0.5);
    return mixed;
}

}  // namespace

Instant SpoiltProjector::show(const RgbImage& picture, Instant valid_until) {
    if (instead) return projector_.show(*instead, valid_until);
    if (shift_px.norm() == 0 && !covered_beyond) return projector_.show(picture, valid_until);
    RgbImage spoilt(picture.width, picture.height);
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
            if (!covered_beyond || covered_beyond->signedDistance(Vector2d(x, y)) < 0)
                spoilt.at(x, y) =
                    shift_px.norm() == 0 ? picture.at(x, y) : between_pixels(picture, Vector2d(x, y) - shift_px);
    return projector_.show(spoilt, valid_until);
}

StereoFrame SpoiltCameras::grab(Instant not_before, std::chrono::milliseconds patience) {
    StereoFrame frame = cameras_.grab(not_before, patience);
    spoil(frame.left, 2 * frame.number), spoil(frame.right, 2 * frame.number + 1);
    return frame;
}

StereoFrame SpoiltCameras::newest(Instant not_before, std::chrono::milliseconds patience) {
    StereoFrame frame = cameras_.newest(not_before, patience);
    spoil(frame.left, 2 * frame.number), spoil(frame.right, 2 * frame.number + 1);
    return frame;
}

void SpoiltCameras::spoil(GrayImage& picture, std::uint64_t seed) const {
    cv::Mat grey(picture.height, picture.width, CV_8U, picture.pixels.data()), fine;
    grey.convertTo(fine, CV_32F);
    if (habits_.blur_px > 0) cv::GaussianBlur(fine, fine, {}, habits_.blur_px);
    if (habits_.sharpening > 0) {
        cv::Mat soft;
        cv::GaussianBlur(fine, soft, {}, 1.5);
        fine += habits_.sharpening * (fine - soft);
    }
    fine = cv::max(fine, 0);
    if (habits_.gamma != 1) {
        cv::pow(fine / 255, 1 / habits_.gamma, fine);
        fine *= 255;
    }
    if (habits_.noise > 0) {
        cv::Mat noise(fine.size(), CV_32F);
        cv::RNG random(seed + 1);
        random.fill(noise, cv::RNG::NORMAL, 0, habits_.noise);
        fine += noise;
    }
    fine.convertTo(grey, CV_8U);
    if (habits_.jpeg_quality > 0) {
        std::vector<unsigned char> bytes;
        cv::imencode(".jpg", grey, bytes, {cv::IMWRITE_JPEG_QUALITY, habits_.jpeg_quality});
        cv::imdecode(bytes, cv::IMREAD_GRAYSCALE).copyTo(grey);
    }
}

FaultyRoom::FaultyRoom(const Volume& volume, const Case& the_case, const CaseDrawing& drawing,
                       const simulation::RoomSettings& room, std::chrono::milliseconds computing,
                       const CameraHabits& habits)
    : computing_(computing),
      random_(room.seed * 7919 + 3),
      rig_(volume, points_of(the_case.plan), room),
      spoilt_(rig_.projector()),
      cameras_(rig_.cameras(), habits),
      session_(the_case, drawing, rig_.calibration(), spoilt_, cameras_, rig_.clock(), settings()) {}

bool FaultyRoom::find_patient() {
    session_.scan();
    if (session_.find_patient().verdict == Verdict::no) return false;
    session_.confirm();
    return true;
}

SessionSettings FaultyRoom::settings() {
    SessionSettings settings;
    settings.while_computing = [this] { rig_.wait(computing_); };
    return settings;
}

void FaultyRoom::move(double speed_mm_s) {
    if (speed_mm_s == speed_mm_s_) return;
    rig_.set_motion({speed_mm_s, rig_.clock().now()});
    speed_mm_s_ = speed_mm_s;
}

Vector3d FaultyRoom::any_axis() {
    const double angle = std::uniform_real_distribution<double>(0, 2 * std::numbers::pi)(random_);
    return {std::cos(angle), std::sin(angle), 0};
}

// From the skin's own shape round the place.
Vector3d FaultyRoom::skin_normal(const Vector3d& at) const {
    const RigidTransform to_rig = rig_.true_rig_from_ct(rig_.clock().now());
    const Vector3d towards = (to_rig.inverse() * rig_.calibration().projector.centre_in_rig() - at).normalized();
    const auto skin = rig_.true_skin_along(at + 20 * towards, -towards);
    return skin ? skin->normal_in_ct : towards;
}

FaultyRoom::Begun FaultyRoom::begin(const std::string& fault, double size) {
    const double turn_rad = size * 0.05 * std::numbers::pi / 180;
    if (fault == "offset") {
        const double mm_per_px = 900 / rig_.calibration().projector.focal_x;
        spoilt_.shift_px = size * 0.5 / mm_per_px * any_axis().head<2>();
        return {[this] { spoilt_.shift_px.setZero(); }, "projector", {}};
    }
    if (fault == "late") {
        const Instant later = std::chrono::duration_cast<Instant>(size * 20ms);
        rig_.delay_light(later);
        return {[this] { rig_.delay_light({}); }, fault, later};
    }
    if (fault == "slip" || fault == "cap") {
        const int markers = static_cast<int>(rig_.true_markers_in_ct().size());
        const int marker = fault == "cap" ? -1 : std::uniform_int_distribution<int>(0, markers - 1)(random_);
        const Vector3d at = rig_.true_markers_in_ct()[static_cast<std::size_t>(std::max(marker, 0))];
        const Vector3d normal = skin_normal(at);
        std::normal_distribution<double> gauss;
        const Vector3d any(gauss(random_), gauss(random_), gauss(random_));
        const Vector3d shift = size * (fault == "cap" ? 2 : 1) * (any - any.dot(normal) * normal).normalized();
        rig_.slip_marker(marker, shift);
        return {[this, marker, shift] { rig_.slip_marker(marker, -shift); }, fault, {}};
    }
    if (fault == "projector" || fault == "camera") {
        auto device = SimulatedRig::Device::projector;
        std::string right = fault;
        if (fault == "camera") {
            const bool left = std::uniform_int_distribution<int>(0, 1)(random_) == 0;
            device = left ? SimulatedRig::Device::left_camera : SimulatedRig::Device::right_camera;
            right = left ? "left camera" : "right camera";
        }
        const Vector3d turn = turn_rad * any_axis();
        rig_.bump(device, turn);
        return {[this, device, turn] { rig_.bump(device, -turn); }, right, {}};
    }
    if (fault == "covered") {
        rig_.cover_projector(true);
        return {[this] { rig_.cover_projector(false); }, fault, {}};
    }
    if (fault == "window") {
        RgbImage desktop(spoilt_.width(), spoilt_.height(), {120, 130, 140});
        for (int y = 0; y < desktop.height / 20; ++y)
            for (int x = 0; x < desktop.width; ++x) desktop.at(x, y) = {230, 230, 230};
        spoilt_.instead = desktop;
        return {[this] { spoilt_.instead.reset(); }, fault, {}};
    }
    if (fault == "half") {
        const Vector2d middle(0.5 * spoilt_.width(), 0.5 * spoilt_.height());
        const double aside_px = std::uniform_real_distribution<double>(-0.15, 0.15)(random_) * spoilt_.width();
        const Vector2d normal = any_axis().head<2>();
        spoilt_.covered_beyond.emplace(normal, Vector2d(middle + aside_px * normal));
        return {[this] { spoilt_.covered_beyond.reset(); }, fault, {}};
    }
    if (fault == "landmark" && !session_.landmarks().empty()) {
        session_.light_landmark(landmark_++ % session_.landmarks().size());
        return {[this] { session_.light_landmark({}); }, "nothing", {}};
    }
    return {[] {}, "nothing", {}};
}

}  // namespace planlight::test
