#include "registration/simulation/simulated_rig.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "planning_io/types/error.h"
#include "registration/simulation/camera_view.h"
#include "registration/simulation/dressed_surface.h"
#include "registration/simulation/hash.h"
#include "registration/simulation/head_motion.h"
#include "registration/simulation/head_pose.h"
#include "registration/simulation/light.h"
#include "registration/simulation/markers.h"
#include "registration/simulation/rig_layout.h"
#include "registration/simulation/sensor.h"
#include "registration/simulation/skin_look.h"
#include "registration/simulation/true_surface.h"
#include "registration/simulation/truth_file.h"

namespace planlight::simulation {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

bool in_picture(const Optics& device, const Vector2d& pixel) {
    return pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() < device.columns - 0.5 && pixel.y() < device.rows - 0.5;
}

}  // namespace

struct SimulatedRig::Room final : Projector, StereoCamera, Clock {
    Room(const Volume& volume, const std::vector<Vector3d>& keep_clear_in_ct, const RoomSettings& given);

    // Clock
    Instant now() const override { return now_; }

    // Projector
    int width() const override { return rig.projector.columns; }
    int height() const override { return rig.projector.rows; }
    Instant show(const RgbImage& picture, Instant valid_until) override;
    void go_dark() noexcept override { schedule.go_dark(now_); }

    // StereoCamera
    StereoFrame grab(Instant not_before, std::chrono::milliseconds patience) override;

    RigidTransform ct_from_room(Instant at) const { return history.room_from_ct(at).inverse(); }
    void add_motion(const Motion& motion);
    void look_at_head(Instant at);
    GrayImage expose(CameraView& view, const Sensor& sensor, const LightMap& light, double lamps, std::uint64_t frame);
    void set_exposure();

    /// Seeded apart for every purpose, so that more of one does not change the others.
    std::mt19937 random_for(unsigned purpose) const {
        return std::mt19937(static_cast<unsigned>(mixed(static_cast<std::uint64_t>(settings.seed) * 64 + purpose)));
    }

    RoomSettings settings;
    TrueSurface skin;
    DressedSurface dressed{skin};
    RigLayout rig;
    RigCalibration calibration;
    SkinLook look;
    std::vector<Vector3d> markers_in_ct;
    HeadHistory history{RigidTransform::Identity()};
    std::mt19937 motion_random;
    LightSchedule schedule{0, 0, {}};
    CameraView left_view, right_view;
    Sensor left_sensor, right_sensor;
    std::optional<Eigen::Matrix4d> seen_room_from_ct;  ///< the pose both views hold
    double gain = 1;      ///< full scales per white light on white paper, at the exposure of the beginning
    double exposure = 1;  ///< times that one
    std::vector<float> light_buffer;
    Instant now_{};
};

SimulatedRig::Room::Room(const Volume& volume, const std::vector<Vector3d>& keep_clear_in_ct, const RoomSettings& given)
    : settings(given), skin(volume, given.skin_threshold_hu), look(given.seed), motion_random(random_for(5)) {
    auto random = random_for(1);
    rig = build_rig(settings.preset, random);
    random = random_for(2);
    calibration = calibrated(rig, settings.calibration_error, random);
    random = random_for(3);
    const WorkRegion region = find_work_region(skin, keep_clear_in_ct);
    history = HeadHistory(lay_head(skin, region, random));
    random = random_for(4);
    const RigidTransform to_ct = ct_from_room({});
    look.stickers =
        place_stickers(skin, region, keep_clear_in_ct, rig.left_camera.seen_from(to_ct),
                       rig.right_camera.seen_from(to_ct), rig.projector.seen_from(to_ct), settings.markers, random);
    look.wet = settings.wet;
    if (settings.things.any()) {
        random = random_for(6);
        dressed.lay(lay_things(skin, region.centre_in_ct, rig.projector.seen_from(to_ct).eye, settings.things, random));
    }
    for (const Sticker& sticker : look.stickers) markers_in_ct.push_back(sticker.centre_in_ct);
    schedule = LightSchedule(rig.projector.columns, rig.projector.rows, settings.projector_delay, settings.light,
                             mixed(static_cast<std::uint64_t>(settings.seed) + 9000));
    left_sensor = {rig.left_camera.columns, rig.left_camera.rows,
                   rig.left_blur_px,        0.85,
                   settings.noise,          mixed(2 * static_cast<std::uint64_t>(settings.seed) + 1000)};
    right_sensor = {rig.right_camera.columns, rig.right_camera.rows,
                    rig.right_blur_px,        0.85,
                    settings.noise,           mixed(2 * static_cast<std::uint64_t>(settings.seed) + 1001)};
    if (settings.motion.speed_mm_s > 0) add_motion(settings.motion);
    set_exposure();
}

void SimulatedRig::Room::add_motion(const Motion& motion) {
    const RigidTransform room_from_ct = history.room_from_ct(now_);
    const Vector3d middle = skin.middle_in_ct();
    Vector3d neck = middle;
    neck.z() = skin.low_in_ct().z() - 40;
    neck.y() += 30;
    history.add(HeadMotion(motion, now_, room_from_ct * neck, room_from_ct * middle, motion_random), now_);
}

/// White light and the room's lamps together make skin that faces the devices about 165 grey in both cameras, so that
/// the white of the stickers is not drowned in saturation.
void SimulatedRig::Room::set_exposure() {
    constexpr double kBrightSkin = 165.0 / 255;
    look_at_head(now_);
    const RgbImage white(width(), height(), {255, 255, 255});
    const LightMap light(width(), height(), &white, settings.light.panel);
    double sum = 0;
    for (CameraView* view : {&left_view, &right_view}) {
        view->expose(light, 1, 0, light_buffer);
        std::erase_if(light_buffer, [](float v) { return v < 0.05F; });
        if (light_buffer.empty()) {
            sum += SkinLook::kSkinAlbedo / 2;
            continue;
        }
        const auto bright = light_buffer.begin() + static_cast<std::ptrdiff_t>(light_buffer.size() * 85 / 100);
        std::nth_element(light_buffer.begin(), bright, light_buffer.end());
        sum += static_cast<double>(*bright) / 2;
    }
    gain = std::max(kBrightSkin - settings.ambient, 0.1) / sum;
}

void SimulatedRig::Room::look_at_head(Instant at) {
    const RigidTransform room_from_ct = history.room_from_ct(at);
    if (seen_room_from_ct && *seen_room_from_ct == room_from_ct.matrix()) return;
    const RigidTransform to_ct = room_from_ct.inverse();
    Scene scene{dressed, look, rig.left_camera.seen_from(to_ct), rig.projector.seen_from(to_ct),
                rig.working_distance_mm};
    left_view.look(scene);
    scene.camera = rig.right_camera.seen_from(to_ct);
    right_view.look(scene);
    seen_room_from_ct = room_from_ct.matrix();
}

GrayImage SimulatedRig::Room::expose(CameraView& view, const Sensor& sensor, const LightMap& light, double lamps,
                                     std::uint64_t frame) {
    const double ambient = exposure * lamps * settings.ambient / SkinLook::kSkinAlbedo;
    view.expose(light, static_cast<float>(exposure * gain), static_cast<float>(ambient), light_buffer);
    return sense(sensor, light_buffer, frame);
}

Instant SimulatedRig::Room::show(const RgbImage& picture, Instant valid_until) {
    const auto pixels = static_cast<std::size_t>(width()) * static_cast<std::size_t>(height());
    if (picture.width != width() || picture.height != height() || picture.pixels.size() != pixels) {
        go_dark();
        throw DeviceError("simulated projector",
                          "a picture of " + std::to_string(picture.width) + "x" + std::to_string(picture.height) +
                              " was to be shown on " + std::to_string(width()) + "x" + std::to_string(height()) +
                              " pixels",
                          "Draw the picture in the projector's own size.");
    }
    schedule.show(picture, now_, valid_until);
    return now_ + settings.projector_delay;
}

StereoFrame SimulatedRig::Room::grab(Instant not_before, std::chrono::milliseconds patience) {
    const Instant from = std::max({not_before, now_, Instant{}});
    auto number = (from.count() + rig.frame_interval.count() - 1) / rig.frame_interval.count();
    while (frame_is_lost(settings.light, settings.seed, number)) ++number;
    const Instant begins = number * rig.frame_interval, ends = begins + rig.exposure;
    if (ends - now_ > patience) {
        now_ += patience;
        throw DeviceError("simulated cameras", "no frame came in " + std::to_string(patience.count()) + " ms",
                          "Wait longer, or ask for an earlier frame.");
    }
    StereoFrame frame;
    frame.at = begins + rig.exposure / 2;
    frame.exposure = rig.exposure;
    frame.number = static_cast<std::uint64_t>(number);
    look_at_head(frame.at);
    const auto light = schedule.during(begins, ends);
    const double lamps = lamps_during(settings.light, begins, ends);
    frame.left = expose(left_view, left_sensor, *light, lamps, frame.number);
    frame.right = expose(right_view, right_sensor, *light, lamps, frame.number);
    now_ = ends;
    return frame;
}

SimulatedRig::SimulatedRig(const Volume& volume, const std::vector<Vector3d>& keep_clear_in_ct,
                           const RoomSettings& settings)
    : room_(std::make_unique<Room>(volume, keep_clear_in_ct, settings)) {}
SimulatedRig::~SimulatedRig() = default;

Projector& SimulatedRig::projector() {
    return *room_;
}
StereoCamera& SimulatedRig::cameras() {
    return *room_;
}
const Clock& SimulatedRig::clock() const {
    return *room_;
}
const RigCalibration& SimulatedRig::calibration() const {
    return room_->calibration;
}
void SimulatedRig::wait(Instant duration) {
    room_->now_ += std::max(duration, Instant{});
}
void SimulatedRig::cover_projector(bool covered) {
    room_->schedule.cover(covered);
}
void SimulatedRig::freeze_projector() {
    room_->schedule.freeze(room_->now_);
}
void SimulatedRig::set_motion(const Motion& motion) {
    room_->add_motion(motion);
}

void SimulatedRig::cover_markers(const std::vector<int>& markers) {
    for (std::size_t i = 0; i < room_->look.stickers.size(); ++i)
        room_->look.stickers[i].covered =
            std::find(markers.begin(), markers.end(), static_cast<int>(i)) != markers.end();
    room_->seen_room_from_ct.reset();
}

void SimulatedRig::bump(Device device, const Vector3d& turn, const Vector3d& shift_mm) {
    RigLayout& rig = room_->rig;
    Optics& optics = device == Device::projector     ? rig.projector
                     : device == Device::left_camera ? rig.left_camera
                                                     : rig.right_camera;
    optics.eye += shift_mm.x() * optics.right + shift_mm.y() * optics.down + shift_mm.z() * optics.forward;
    optics.turn(turn);
    room_->seen_room_from_ct.reset();
}

void SimulatedRig::slip_marker(int marker, const Vector3d& shift_in_ct) {
    for (std::size_t i = 0; i < room_->look.stickers.size(); ++i) {
        if (marker >= 0 && static_cast<int>(i) != marker) continue;
        Sticker& sticker = room_->look.stickers[i];
        const auto place = room_->skin.nearest(sticker.centre_in_ct + shift_in_ct);
        sticker.centre_in_ct = room_->markers_in_ct[i] = place.p_in_ct;
        sticker.normal_in_ct = place.normal_in_ct;
    }
    room_->seen_room_from_ct.reset();
}

void SimulatedRig::set_lamps(double ambient, double exposure) {
    room_->settings.ambient = ambient;
    room_->exposure = exposure;
}

void SimulatedRig::delay_light(Instant untold) {
    room_->schedule.set_untold_delay(untold);
}

RigidTransform SimulatedRig::true_rig_from_ct(Instant at) const {
    return room_->rig.room_from_rig.inverse() * room_->history.room_from_ct(at);
}

Vector3d SimulatedRig::nearest_true_skin(const Vector3d& p_in_ct) const {
    return room_->skin.nearest(p_in_ct).p_in_ct;
}

std::vector<double> SimulatedRig::scan_errors_mm(const std::vector<Vector3d>& points_in_rig, Instant at) const {
    const RigidTransform ct_from_rig = true_rig_from_ct(at).inverse();
    std::vector<double> errors;
    errors.reserve(points_in_rig.size());
    for (const Vector3d& p : points_in_rig) errors.push_back(room_->skin.nearest(ct_from_rig * p).signed_mm);
    return errors;
}

std::optional<SimulatedRig::Lit> SimulatedRig::true_light(const Vector2d& pixel_in_projector, Instant at) const {
    const Optics projector = room_->rig.projector.seen_from(room_->ct_from_room(at));
    const auto hit = room_->dressed.first_hit(projector.eye, projector.direction_of(pixel_in_projector));
    if (!hit || hit->made_of != Material::none) return std::nullopt;
    return Lit{hit->p_in_ct, hit->normal_in_ct};
}

std::optional<SimulatedRig::Lit> SimulatedRig::true_skin_along(const Vector3d& origin_in_ct,
                                                               const Vector3d& direction) const {
    const auto hit = room_->skin.first_hit(origin_in_ct, direction);
    if (!hit) return std::nullopt;
    return Lit{hit->p_in_ct, hit->normal_in_ct};
}

std::optional<SimulatedRig::Sight> SimulatedRig::true_sight(Camera camera, const Vector2d& pixel, Instant at) const {
    const RigidTransform to_ct = room_->ct_from_room(at);
    const RigLayout& rig = room_->rig;
    const Optics eye = (camera == Camera::left ? rig.left_camera : rig.right_camera).seen_from(to_ct);
    const auto hit = room_->dressed.first_hit(eye.eye, eye.direction_of(pixel));
    if (!hit || hit->made_of != Material::none) return std::nullopt;
    Sight sight{hit->p_in_ct, hit->normal_in_ct, std::nullopt};
    const Optics lamp = rig.projector.seen_from(to_ct);
    if (hit->normal_in_ct.dot(lamp.eye - hit->p_in_ct) <= 0 || lamp.depth(hit->p_in_ct) <= 0) return sight;
    const Vector2d lit_by = lamp.pixel_of(hit->p_in_ct);
    if (in_picture(lamp, lit_by) && !room_->dressed.in_shadow(hit->p_in_ct, hit->normal_in_ct, lamp.eye))
        sight.lit_by = lit_by;
    return sight;
}

bool SimulatedRig::truly_seen(Camera camera, const Lit& skin, Instant at) const {
    const RigLayout& rig = room_->rig;
    const Optics eye = (camera == Camera::left ? rig.left_camera : rig.right_camera).seen_from(room_->ct_from_room(at));
    return eye.depth(skin.p_in_ct) > 0 && in_picture(eye, eye.pixel_of(skin.p_in_ct)) &&
           !room_->dressed.in_shadow(skin.p_in_ct, skin.normal_in_ct, eye.eye);
}

const std::vector<Vector3d>& SimulatedRig::true_markers_in_ct() const {
    return room_->markers_in_ct;
}
const std::vector<TrueLight>& SimulatedRig::true_lights() const {
    return room_->schedule.truth();
}
RigCalibration SimulatedRig::true_rig() const {
    return exported(room_->rig);
}

std::string SimulatedRig::truth_json() const {
    TruthNumbers truth;
    truth.settings = room_->settings;
    truth.at = room_->now_;
    truth.rig_from_ct = true_rig_from_ct(truth.at);
    for (const Sticker& sticker : room_->look.stickers) {
        truth.markers_in_ct.push_back(sticker.centre_in_ct);
        truth.marker_normals_in_ct.push_back(sticker.normal_in_ct);
        truth.markers_covered.push_back(sticker.covered);
    }
    truth.true_rig = true_rig();
    truth.calibration = room_->calibration;
    truth.left_blur_px = room_->rig.left_blur_px;
    truth.right_blur_px = room_->rig.right_blur_px;
    truth.gain = room_->gain;
    return as_json(truth);
}

}  // namespace planlight::simulation
